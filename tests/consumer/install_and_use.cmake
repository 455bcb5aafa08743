cmake_minimum_required(VERSION 3.25)
set(prefix ${CONSUMER_BINARY_DIR}/prefix)
set(build ${CONSUMER_BINARY_DIR}/build)
file(REMOVE_RECURSE ${prefix} ${build} ${build}_calib ${build}_unknown ${build}_run)
file(MAKE_DIRECTORY ${build}_run)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result WORKING_DIRECTORY ${build}_run)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "exit code ${result}: ${command}")
  endif()
endfunction()

set(settings -G ${GENERATOR} -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH=${prefix}
             -D CMAKE_CXX_COMPILER=${CXX_COMPILER} -D CMAKE_CXX_FLAGS=${CXX_FLAGS}
             -D CMAKE_FIND_USE_PACKAGE_REGISTRY=OFF -D EXAMPLES_DIR=${EXAMPLES_DIR})
cmake_path(GET CONSUMER_SOURCE_DIR PARENT_PATH projects)
set(share ${prefix}/share/vernier)

run(${CMAKE_COMMAND} --install ${VERNIER_BUILD_DIR} --prefix ${prefix})
run(${CMAKE_COMMAND} -S ${CONSUMER_SOURCE_DIR} -B ${build} ${settings})
run(${CMAKE_COMMAND} --build ${build})
run(${build}/consumer ${share}/worlds/workshop.world.toml)
file(GLOB examples ${EXAMPLES_DIR}/*.cpp)
foreach(source IN LISTS examples)
  cmake_path(GET source STEM example)
  message(STATUS "${example}")
  run(${build}/${example} ${share})
endforeach()

# calib alone, where neither TBB nor SQLite can be found
run(${CMAKE_COMMAND} -S ${projects}/calib_only -B ${build}_calib ${settings}
    -D CMAKE_DISABLE_FIND_PACKAGE_TBB=ON -D CMAKE_DISABLE_FIND_PACKAGE_SQLite3=ON)
run(${CMAKE_COMMAND} --build ${build}_calib)
run(${build}_calib/calib_only ${share})

# A component that is none: refused with a message, and an error where the package is required.
set(unknown ${CMAKE_COMMAND} -S ${projects}/unknown_component -B ${build}_unknown ${settings})
run(${unknown})
execute_process(COMMAND ${unknown} -D REQUIRED_TOO=ON RESULT_VARIABLE result ERROR_VARIABLE message
                OUTPUT_QUIET)
string(REGEX REPLACE "[ \n]+" " " message "${message}")
if(result EQUAL 0 OR NOT message MATCHES "vernier has no component \"lidar\"; its components are")
  message(FATAL_ERROR "an unknown component gave ${result}: ${message}")
endif()

# The installed program must find what is installed with it, and nothing that it needs stay behind.
if(EXISTS ${prefix}/bin/vernier)
  set(vernier ${CMAKE_COMMAND} -E env --unset=VERNIER_SHARE ${prefix}/bin/vernier)
  run(${vernier} world info workshop)
  set(built_page ${VERNIER_BUILD_DIR}/share/vernier/page)
  file(GLOB built RELATIVE ${built_page} ${built_page}/*)
  file(GLOB installed RELATIVE ${share}/page ${share}/page/*)
  if(NOT built OR NOT installed STREQUAL built)
    message(FATAL_ERROR "share/vernier/page holds \"${installed}\", the build's \"${built}\"")
  endif()
  if("report.js" IN_LIST built) # not where the build had no esbuild
    run(${vernier} report nominal --no-proof -o r.html)
    file(READ ${build}_run/r.html page)
    if(NOT page MATCHES "id=\"data\"" OR page MATCHES "<!--VERNIER:")
      message(FATAL_ERROR "r.html is no filled page")
    endif()
  endif()
endif()
