# Debian packages of what Install.cmake and tools/ install, one a component:
#
#   cmake --build build/release --target isowave_installed     only what is installed: no tests
#   cpack --config build/release/CPackConfig.cmake -B dist
#
#   tool     isowave            the command, man pages, completion
#   dev      libisowave-dev     headers, libraries, CMake package
#   python   python3-isowave    the Python module, with -DISOWAVE_PYTHON=ON
set(ISOWAVE_MAINTAINER "isowave <isowave@packages.invalid>" CACHE STRING "who makes the packages: Name <address>")

install(FILES LICENSE cmake/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/isowave COMPONENT tool)
install(FILES LICENSE cmake/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libisowave-dev COMPONENT dev)
if(ISOWAVE_PYTHON)
  install(FILES LICENSE cmake/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/python3-isowave COMPONENT python)
endif()

# What is installed is built by this target. Without the next line cpack would first build everything there is, tests too.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)
add_custom_target(isowave_installed DEPENDS isowave_tool isowave_pages)
foreach(module ${all_modules} simplify)
  if(TARGET isowave_${module})
    add_dependencies(isowave_installed isowave_${module})
  endif()
endforeach()
if(ISOWAVE_SHARED)
  add_dependencies(isowave_installed isowave_shared)
endif()
if(ISOWAVE_PYTHON)
  add_dependencies(isowave_installed isowave_python)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL tool dev)
if(ISOWAVE_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGE_NAME isowave)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT ${ISOWAVE_MAINTAINER})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_TOOL_PACKAGE_NAME isowave)
set(CPACK_DEBIAN_TOOL_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_TOOL_PACKAGE_SHLIBDEPS ON)  # what the program is linked to
set(CPACK_COMPONENT_TOOL_DESCRIPTION "The command takes a CT scan, a mesh or a level set apart and gives a closed
mesh at every level, from full detail down to a blob.")

# Static libraries: what they use has to be there when a program is linked; isowaveConfig.cmake looks for it.
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libisowave-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libopenvdb-dev, libboost-iostreams-dev, libtbb-dev, libgdcm-dev, libtiff-dev, libpng-dev, \
zlib1g-dev, libexpat1-dev, libzip-dev, zipcmp, zipmerge, ziptool, libdraco-dev, pkg-config, libblosc-dev, libzstd-dev, liblz4-dev, libfmt-dev, libgmp-dev, libmpfr-dev")
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS "isowave, cmake, g++")
set(CPACK_COMPONENT_DEV_DESCRIPTION "The library: headers, static libraries and a CMake package.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-isowave)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.11), python3 (<< 3.12), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
  "${PROJECT_SOURCE_DIR}/cmake/python3-isowave/postinst;${PROJECT_SOURCE_DIR}/cmake/python3-isowave/prerm")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-nibabel")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "The Python module: NumPy arrays and files in, meshes and reports out.")

include(CPack)
