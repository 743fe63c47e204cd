# `cmake --install` gives an outside project find_package(fascia): headers, one target per module
# and the package description.
include(CMakePackageConfigHelpers)
get_property(modules GLOBAL PROPERTY FASCIA_MODULES)
list(TRANSFORM modules PREPEND fascia_ OUTPUT_VARIABLE targets)
set(packageDir "${CMAKE_INSTALL_LIBDIR}/cmake/fascia")

install(TARGETS ${targets} EXPORT fascia-targets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
install(EXPORT fascia-targets NAMESPACE fascia:: DESTINATION "${packageDir}")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/src/fascia" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
  FILES_MATCHING PATTERN "*.h")
configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/fascia-config.cmake.in"
  "${PROJECT_BINARY_DIR}/fascia-config.cmake" INSTALL_DESTINATION "${packageDir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/fascia-config-version.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES
  "${PROJECT_BINARY_DIR}/fascia-config.cmake"
  "${PROJECT_BINARY_DIR}/fascia-config-version.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/FasciaDependencies.cmake"
  DESTINATION "${packageDir}")

install(DIRECTORY "${PROJECT_SOURCE_DIR}/examples" "${PROJECT_SOURCE_DIR}/schema"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/fascia")
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}")
if(FASCIA_BUILD_PROGRAM)
  install(TARGETS fascia RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
endif()
