function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE "${SCRATCH}")
run(${CMAKE_COMMAND} --install "${BUILD}" --config "${CONFIG}" --prefix "${SCRATCH}/prefix")
# A fresh copy, so that no path of this tree can leak in.
file(COPY "${OUTSIDE}/" DESTINATION "${SCRATCH}/outside")
run(${CMAKE_COMMAND} -S "${SCRATCH}/outside" -B "${SCRATCH}/build" -G "${GENERATOR}"
  -D CMAKE_BUILD_TYPE=${CONFIG} -D CMAKE_CXX_COMPILER=${COMPILER} "-DCMAKE_CXX_FLAGS=${FLAGS}"
  -D CMAKE_PREFIX_PATH=${SCRATCH}/prefix)
run(${CMAKE_COMMAND} --build "${SCRATCH}/build")
run("${SCRATCH}/build/hello" "${SCRATCH}/build/hello.glb")
if(NOT EXISTS "${SCRATCH}/build/hello.glb")
  message(FATAL_ERROR "hello wrote no file")
endif()
