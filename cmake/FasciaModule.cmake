# One module = one folder under src/fascia = one static library target fascia::<name>.

add_library(fascia_options INTERFACE)
target_compile_options(fascia_options INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Woverloaded-virtual
  $<$<BOOL:${FASCIA_WERROR}>:-Werror>
  # Same bits everywhere on one machine: the compiler may not contract or reorder by itself.
  -ffp-contract=off)
if(FASCIA_SCALAR_SIMD)
  target_compile_definitions(fascia_options INTERFACE HWY_COMPILE_ONLY_SCALAR)
endif()

# fascia_module(<name> [DEPENDS <module>...] [LINK <target>...] [LINK_PRIVATE <target>...])
# Sources are every *.cpp below the folder: a new solid, solver or format is one new file.
function(fascia_module name)
  cmake_parse_arguments(ARG "" "" "DEPENDS;LINK;LINK_PRIVATE" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp")
  set(target fascia_${name})
  add_library(${target} STATIC ${sources})
  # Highway includes these once per instruction set, by their own name.
  list(FILTER sources INCLUDE REGEX "kernels\\.cpp$")
  set_source_files_properties(${sources} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  add_library(fascia::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES
    EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  list(TRANSFORM ARG_DEPENDS PREPEND fascia_)
  target_link_libraries(${target}
    PUBLIC ${ARG_DEPENDS} ${ARG_LINK}
    PRIVATE ${ARG_LINK_PRIVATE} $<BUILD_INTERFACE:fascia_options>)
  # Nothing here runs in every frame, and -O3 takes twice as long to compile it.
  if(name STREQUAL "io")
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O2>)
  endif()
  # Half of what a file costs to compile are the headers that all have in common. Files include what
  # they use all the same: a build with CMAKE_DISABLE_PRECOMPILE_HEADERS, file by file, sees to it.
  if(name STREQUAL "math")
    target_precompile_headers(${target} PRIVATE <Eigen/Core> <Eigen/Geometry> <algorithm> <cmath>
      <functional> <memory> <span> <string> <string_view> <vector>)
  elseif(NOT name STREQUAL "base")
    target_precompile_headers(${target} REUSE_FROM fascia_math)
  endif()
  set_property(GLOBAL APPEND PROPERTY FASCIA_MODULES ${name})
endfunction()
