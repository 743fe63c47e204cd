# `cmake --install` gives an outside project find_package(fascia): the target fascia::fascia, its
# header fascia/fascia.h with those that it includes, and the package description. Static modules
# come along as targets of their own, but what is behind the facade is nobody's business.
include(CMakePackageConfigHelpers)
get_property(modules GLOBAL PROPERTY FASCIA_MODULES)
list(TRANSFORM modules PREPEND fascia_ OUTPUT_VARIABLE targets)
set(packageDir "${CMAKE_INSTALL_LIBDIR}/cmake/fascia")

# Every header that one of the list includes, itself included: paths from src/.
function(fascia_reached_headers out)
  set(waiting ${ARGN})
  set(reached)
  while(waiting)
    list(POP_FRONT waiting header)
    if(NOT header IN_LIST reached)
      list(APPEND reached "${header}")
      file(STRINGS "${PROJECT_SOURCE_DIR}/src/${header}" lines REGEX "^#include <fascia/")
      list(TRANSFORM lines REPLACE "^#include <(fascia/[^>]+)>.*$" "\\1")
      list(APPEND waiting ${lines})
      set_property(DIRECTORY "${PROJECT_SOURCE_DIR}" APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
        "${PROJECT_SOURCE_DIR}/src/${header}")
    endif()
  endwhile()
  set(${out} ${reached} PARENT_SCOPE)
endfunction()

install(TARGETS fascia_library ${targets} EXPORT fascia-targets
  ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT library)
install(EXPORT fascia-targets NAMESPACE fascia:: DESTINATION "${packageDir}" COMPONENT library)
fascia_reached_headers(publicHeaders fascia/fascia.h)
foreach(header IN LISTS publicHeaders)
  cmake_path(GET header PARENT_PATH folder)
  install(FILES "${PROJECT_SOURCE_DIR}/src/${header}"
    DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/${folder}" COMPONENT library)
endforeach()
configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/fascia-config.cmake.in"
  "${PROJECT_BINARY_DIR}/fascia-config.cmake" INSTALL_DESTINATION "${packageDir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/fascia-config-version.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES
  "${PROJECT_BINARY_DIR}/fascia-config.cmake"
  "${PROJECT_BINARY_DIR}/fascia-config-version.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/FasciaDependencies.cmake"
  DESTINATION "${packageDir}" COMPONENT library)

install(DIRECTORY "${PROJECT_SOURCE_DIR}/examples" "${PROJECT_SOURCE_DIR}/schema"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/fascia" COMPONENT program)
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" "${PROJECT_SOURCE_DIR}/README.md"
  "${PROJECT_SOURCE_DIR}/CHANGELOG.md" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program
  FILES_MATCHING PATTERN "*.md")
if(FASCIA_BUILD_PROGRAM)
  # The archive of script/package has the libraries beside the program; a package of the system has
  # them where the system looks anyway. An old-style path holds for the libraries' own libraries too.
  set(bundledDir "${CMAKE_INSTALL_LIBDIR}/fascia")
  file(RELATIVE_PATH toBundled "/${CMAKE_INSTALL_BINDIR}" "/${bundledDir}")
  set_target_properties(fascia PROPERTIES INSTALL_RPATH "$ORIGIN/${toBundled}")
  target_link_options(fascia PRIVATE -Wl,--disable-new-dtags)
  install(TARGETS fascia RUNTIME_DEPENDENCY_SET fascia_libraries
    RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT program)
  # What every system has, and what must be the system's own, is not bundled.
  install(RUNTIME_DEPENDENCY_SET fascia_libraries
    PRE_EXCLUDE_REGEXES "^ld-linux" "^libc\\.so" "^libm\\.so" "^libpthread" "^libdl\\.so" "^librt\\.so"
      "^libstdc\\+\\+" "^libgcc_s"
    LIBRARY DESTINATION "${bundledDir}" COMPONENT bundled EXCLUDE_FROM_ALL)
  include("${CMAKE_CURRENT_LIST_DIR}/FasciaPackage.cmake")
endif()
