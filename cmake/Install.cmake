# The installed package: find_package(isowave) gives isowave::isowave, the whole library under one name, and each
# module by its own (isowave::volume, isowave::wavelets ...). isowave::measure is left out of isowave::isowave: it
# links CGAL's GPL packages, and who wants that shall say so.
include(CMakePackageConfigHelpers)

add_library(isowave INTERFACE)
add_library(isowave::isowave ALIAS isowave)
set(umbrella base volume wavelets polygonize curves2d subdivision pictures)
foreach(module ${umbrella})
  target_link_libraries(isowave INTERFACE isowave::${module})
endforeach()

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/isowave)
get_property(targets GLOBAL PROPERTY ISOWAVE_MODULES)
install(TARGETS isowave ${targets} EXPORT isowaveTargets)
install(EXPORT isowaveTargets NAMESPACE isowave:: DESTINATION ${package_dir})

# Headers keep their folders: #include "wavelets/interval/interval.h" with include/isowave on the path. Those of
# isowave::measure come only with the library that they promise, base/heap.h not at all: it is for our programs.
set(left_out PATTERN "heap.h" EXCLUDE)
if(NOT ISOWAVE_MEASURE)
  list(APPEND left_out PATTERN "measure*.h" EXCLUDE)
endif()
foreach(module ${umbrella} subdivision)
  if(EXISTS ${PROJECT_SOURCE_DIR}/${module})
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/${module} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/isowave
            FILES_MATCHING PATTERN "*.h" ${left_out})
  endif()
endforeach()
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

configure_package_config_file(cmake/isowaveConfig.cmake.in ${CMAKE_BINARY_DIR}/isowaveConfig.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/isowaveConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/isowaveConfig.cmake ${CMAKE_BINARY_DIR}/isowaveConfigVersion.cmake
        DESTINATION ${package_dir})

# The package as a program elsewhere uses it.
if(ISOWAVE_TESTS)
  add_test(NAME Install.AProgramElsewhereBuildsAgainstThePackage
    COMMAND ${CMAKE_COMMAND} -DBUILD=${CMAKE_BINARY_DIR} -DSOURCE=${PROJECT_SOURCE_DIR}
      -DWORK=${CMAKE_BINARY_DIR}/install_test -DCOMPILER=${CMAKE_CXX_COMPILER} -DMEASURE=${ISOWAVE_MEASURE}
      -P ${PROJECT_SOURCE_DIR}/tests/install/run.cmake)
  set_tests_properties(Install.AProgramElsewhereBuildsAgainstThePackage PROPERTIES LABELS slow TIMEOUT 600)
endif()
