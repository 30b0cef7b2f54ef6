# isowave::isowave: the whole library under one name. Installed with a config and a version file.
add_library(isowave INTERFACE)
add_library(isowave::isowave ALIAS isowave)
set(modules base volume wavelets polygonize)
foreach(module ${modules})
  target_link_libraries(isowave INTERFACE isowave::${module})
endforeach()

get_property(targets GLOBAL PROPERTY ISOWAVE_MODULES)
install(TARGETS isowave ${targets} EXPORT isowaveTargets)
install(EXPORT isowaveTargets NAMESPACE isowave:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/isowave)
foreach(module ${modules})
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${module} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/isowave
          FILES_MATCHING PATTERN "*.h")
endforeach()
include(CMakePackageConfigHelpers)
configure_package_config_file(cmake/isowaveConfig.cmake.in ${CMAKE_BINARY_DIR}/isowaveConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/isowave)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/isowaveConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/isowaveConfig.cmake ${CMAKE_BINARY_DIR}/isowaveConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/isowave)
