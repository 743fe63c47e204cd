# What the modules link. Used by the build, and by the installed package (static libraries pass
# their private dependencies on to whoever links them).
find_package(Eigen3 3.4 REQUIRED)
find_package(TBB REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)
find_package(ZLIB REQUIRED)
find_package(meshoptimizer REQUIRED)
find_package(draco REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(hwy REQUIRED QUIET IMPORTED_TARGET libhwy)
# Its CMake target wants libminizip-dev, which it does not need.
pkg_check_modules(assimp REQUIRED QUIET IMPORTED_TARGET assimp)
pkg_check_modules(epoxy REQUIRED QUIET IMPORTED_TARGET epoxy)
pkg_check_modules(egl REQUIRED QUIET IMPORTED_TARGET egl)
# Lua compiled as C++: its errors are exceptions, so that destructors run.
pkg_check_modules(lua REQUIRED QUIET IMPORTED_TARGET lua5.4-c++)
