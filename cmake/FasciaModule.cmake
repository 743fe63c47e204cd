# One module = one folder under src/fascia = one static library target fascia_<name>.

add_library(fascia_options INTERFACE)
target_compile_options(fascia_options INTERFACE
  $<BUILD_INTERFACE:-Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor
  -Woverloaded-virtual $<$<BOOL:${FASCIA_WERROR}>:-Werror>>)
# Same bits everywhere on one machine: the compiler may not contract or reorder by itself.
target_compile_options(fascia_options INTERFACE $<BUILD_INTERFACE:-ffp-contract=off>)
if(FASCIA_SCALAR_SIMD)
  target_compile_definitions(fascia_options INTERFACE HWY_COMPILE_ONLY_SCALAR)
endif()

# fascia_module(<name> [DEPENDS <module>...] [LINK <target>...] [LINK_PRIVATE <target>...])
# Sources are every *.cpp below the folder: a new solid, solver or format is one new file.
function(fascia_module name)
  cmake_parse_arguments(ARG "" "" "DEPENDS;LINK;LINK_PRIVATE" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp")
  if(sources)
    add_library(fascia_${name} STATIC ${sources})
    set(scope PUBLIC)
    set(private PRIVATE)
    set_target_properties(fascia_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  else()
    add_library(fascia_${name} INTERFACE)
    set(scope INTERFACE)
    set(private INTERFACE)
  endif()
  add_library(fascia::${name} ALIAS fascia_${name})
  set_target_properties(fascia_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(fascia_${name} ${scope} cxx_std_20)
  target_include_directories(fascia_${name} ${scope}
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:include>)
  foreach(module IN LISTS ARG_DEPENDS)
    target_link_libraries(fascia_${name} ${scope} fascia_${module})
  endforeach()
  target_link_libraries(fascia_${name} ${scope} ${ARG_LINK} ${private} ${ARG_LINK_PRIVATE}
    $<BUILD_INTERFACE:fascia_options>)
  set_property(GLOBAL APPEND PROPERTY FASCIA_MODULES ${name})
endfunction()
