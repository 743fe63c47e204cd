# Read by cpack once per kind of package.
set(CPACK_COMPONENTS_ALL program)
if(CPACK_GENERATOR STREQUAL "TGZ")
  list(APPEND CPACK_COMPONENTS_ALL bundled)
  set(CPACK_PACKAGE_FILE_NAME "fascia-${CPACK_PACKAGE_VERSION}-linux-${CPACK_FASCIA_PROCESSOR}")
endif()
