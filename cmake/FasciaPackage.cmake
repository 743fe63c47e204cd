# What `cpack` makes of the program (script/package calls it): a Debian package, which depends on the
# system's libraries, and an archive that has them inside and runs from any folder.
set(CPACK_PACKAGE_NAME fascia)
set(CPACK_PACKAGE_VENDOR "The Fascia authors")
set(CPACK_PACKAGE_CONTACT "The Fascia authors <fascia@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Layered elastic characters for the command line")
set(CPACK_PACKAGE_DESCRIPTION "Gives rigged characters flesh, fat and an elastic skin, simulates how
they move, and writes glTF, point caches, pictures and videos.")
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
set(CPACK_STRIP_FILES ON)
set(CPACK_FASCIA_PROCESSOR "${CMAKE_SYSTEM_PROCESSOR}")
set(CPACK_GENERATOR "DEB;TGZ")
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_ARCHIVE_COMPONENT_INSTALL ON)
set(CPACK_COMPONENT_INCLUDE_TOPLEVEL_DIRECTORY ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# Drivers and ffmpeg are found when the program runs: it computes without, but draws no pictures.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libegl-mesa0, libgl1-mesa-dri, ffmpeg")
set(CPACK_PROJECT_CONFIG_FILE "${CMAKE_CURRENT_LIST_DIR}/FasciaPackageParts.cmake")
include(CPack)
