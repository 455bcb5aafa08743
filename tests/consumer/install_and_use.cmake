cmake_minimum_required(VERSION 3.25)
set(prefix ${CONSUMER_BINARY_DIR}/prefix)
set(build ${CONSUMER_BINARY_DIR}/build)
file(REMOVE_RECURSE ${prefix} ${build})

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "exit code ${result}: ${command}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --install ${VERNIER_BUILD_DIR} --prefix ${prefix})
run(${CMAKE_COMMAND} -S ${CONSUMER_SOURCE_DIR} -B ${build} -G ${GENERATOR}
    -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH=${prefix}
    -D CMAKE_CXX_COMPILER=${CXX_COMPILER} -D CMAKE_CXX_FLAGS=${CXX_FLAGS}
    -D CMAKE_FIND_USE_PACKAGE_REGISTRY=OFF)
run(${CMAKE_COMMAND} --build ${build})
run(${build}/consumer ${prefix}/share/vernier/worlds/workshop.world.toml)

# The installed program must find what is installed with it.
if(EXISTS ${prefix}/bin/vernier)
  run(${prefix}/bin/vernier world info workshop)
endif()
