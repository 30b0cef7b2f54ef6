# The installed package. find_package(isowave) gives
#
#   isowave::isowave   the whole library; nothing in it is under the GPL
#   isowave::gpl       the same with simplify/, CGAL's GPL packages: a program that links it is under GPL-3
#
# and find_package(isowave COMPONENTS curves) only isowave::curves, which needs neither OpenVDB nor GDCM nor CGAL;
# likewise subdivision and volume. Headers are those of include/isowave, nothing else.
#
# Static, each folder's library is installed as it is. With BUILD_SHARED_LIBS there is one libisowave.so (with simplify/
# unless -DISOWAVE_GPL=OFF), and all names above stand for it.
include(CMakePackageConfigHelpers)
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME dev)  # Package.cmake makes a Debian package of each component

set(ISOWAVE_COMPONENTS base curves subdivision volume)
set(base_modules base vtk mesh picture vector)
set(curves_modules interval curves2d)
set(subdivision_modules subdivision_filters subdivision_curves subdivision_lattice subdivision_meshes subdivision)
set(volume_modules image volume compress_coder compress wavelets polygonize hold lod without_simplify)
set(all_modules ${base_modules} ${curves_modules} ${subdivision_modules} ${volume_modules})
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/isowave)

# isowave_package_target(NAME LIB ...): isowave::NAME, which links the libraries.
function(isowave_package_target name)
  set(target isowave_package_${name})
  add_library(${target} INTERFACE)
  if(NOT TARGET isowave::${name})
    add_library(isowave::${name} ALIAS ${target})
  endif()
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(${target} INTERFACE cxx_std_20)
  target_include_directories(${target} INTERFACE
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(${target} INTERFACE ${ARGN})
endfunction()

if(ISOWAVE_SHARED)
  set(simplifier without_simplify)
  if(ISOWAVE_GPL)
    set(simplifier simplify)
  endif()
  list(REMOVE_ITEM all_modules without_simplify)
  list(APPEND all_modules ${simplifier})
  foreach(module ${all_modules})
    list(APPEND objects $<TARGET_OBJECTS:isowave_${module}>)
    list(APPEND archives isowave_${module})
  endforeach()
  add_library(isowave_shared SHARED ${objects})
  set_target_properties(isowave_shared PROPERTIES
    OUTPUT_NAME isowave VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_link_libraries(isowave_shared PRIVATE ${archives})  # nothing is left to take from them but what they link
  target_link_options(isowave_shared PRIVATE -Wl,--no-undefined)
  foreach(name isowave curves subdivision volume)
    isowave_package_target(${name} isowave_shared)
  endforeach()
  if(ISOWAVE_GPL)
    isowave_package_target(gpl isowave_shared)
  endif()
  install(TARGETS isowave_shared EXPORT isowaveTargets-base LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
else()
  foreach(component ${ISOWAVE_COMPONENTS})
    list(TRANSFORM ${component}_modules PREPEND isowave_ OUTPUT_VARIABLE ${component}_targets)
    install(TARGETS ${${component}_targets} EXPORT isowaveTargets-${component}
            ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  endforeach()
  isowave_package_target(curves isowave_curves2d)
  isowave_package_target(subdivision isowave_subdivision)
  isowave_package_target(volume isowave_lod isowave_without_simplify)
  isowave_package_target(isowave isowave_package_curves isowave_package_subdivision isowave_package_volume)
  if(ISOWAVE_GPL)
    isowave_package_target(gpl isowave_package_curves isowave_package_subdivision isowave_lod isowave_simplify)
    install(TARGETS isowave_simplify EXPORT isowaveTargets-volume ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  endif()
endif()
install(TARGETS isowave_package_curves EXPORT isowaveTargets-curves)
install(TARGETS isowave_package_subdivision EXPORT isowaveTargets-subdivision)
install(TARGETS isowave_package_volume isowave_package_isowave EXPORT isowaveTargets-volume)
if(ISOWAVE_GPL)
  install(TARGETS isowave_package_gpl EXPORT isowaveTargets-volume)
endif()

foreach(component ${ISOWAVE_COMPONENTS})
  install(EXPORT isowaveTargets-${component} NAMESPACE isowave:: DESTINATION ${package_dir})
endforeach()
install(DIRECTORY include/isowave DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})

configure_package_config_file(cmake/isowaveConfig.cmake.in ${CMAKE_BINARY_DIR}/isowaveConfig.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/isowaveConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/isowaveConfig.cmake ${CMAKE_BINARY_DIR}/isowaveConfigVersion.cmake
        DESTINATION ${package_dir})

# The package as programs elsewhere use it: examples/, built against an install prefix and run.
if(ISOWAVE_TESTS)
  add_test(NAME Install.TheExamplesBuildAgainstThePackageAndRun
    COMMAND ${CMAKE_COMMAND} -DBUILD=${CMAKE_BINARY_DIR} -DSOURCE=${PROJECT_SOURCE_DIR}
      -DWORK=${CMAKE_BINARY_DIR}/install_test -DCOMPILER=${CMAKE_CXX_COMPILER} -DGPL=${ISOWAVE_GPL}
      -DSHARED=${ISOWAVE_SHARED} -P ${PROJECT_SOURCE_DIR}/tests/install/run.cmake)
  set_tests_properties(Install.TheExamplesBuildAgainstThePackageAndRun PROPERTIES LABELS slow TIMEOUT 600)
  # 77: there is no debootstrap, no root or no network; ctest lists the test as skipped, and its output says what is missing.
  add_test(NAME Install.PackagesRunInACleanDebian
    COMMAND ${PROJECT_SOURCE_DIR}/tests/install/packages ${CMAKE_BINARY_DIR} ${CMAKE_BINARY_DIR}/package_test)
  set_tests_properties(Install.PackagesRunInACleanDebian PROPERTIES
    LABELS slow TIMEOUT 1800 SKIP_RETURN_CODE 77 RUN_SERIAL TRUE)
endif()
