# vernier_module_headers(NAME): what nearly every source includes, compiled once for all targets with
# the same options, which name it by REUSE_FROM. It links to Eigen alone: the compiler refuses a
# precompiled header with a definition that a source does not have.
function(vernier_module_headers name)
  file(CONFIGURE OUTPUT ${name}.cpp CONTENT "")
  add_library(${name} OBJECT EXCLUDE_FROM_ALL ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  target_compile_features(${name} PUBLIC cxx_std_20)
  target_link_libraries(${name} PRIVATE Eigen3::Eigen)
  target_precompile_headers(${name} PRIVATE <Eigen/Core> <Eigen/Geometry> <Eigen/LU>
                                            ${PROJECT_SOURCE_DIR}/calib/base/eigen_kernels.h)
endfunction()

# vernier_module(NAME PUBLIC … ROOMS … SOURCES … DEPENDS … PRIVATE … HEADER_ONLY …)
# One static (or shared) library vernier::NAME. PUBLIC headers are installed and included as
# "NAME/header.h", in the tree and after installation alike. ROOMS are sub-folders that add their
# sources and internal headers to the library. DEPENDS are the modules to its left; PRIVATE
# libraries never appear in public headers. Of HEADER_ONLY libraries the sources see the headers and
# nothing is linked, so that the installed package does not name them.
function(vernier_module name)
  set(gcc_false_alarms -Wno-restrict -Wno-stringop-overflow -Wno-maybe-uninitialized
                       -Wno-use-after-free)
  cmake_parse_arguments(ARG "" "" "PUBLIC;ROOMS;SOURCES;DEPENDS;PRIVATE;HEADER_ONLY" ${ARGN})
  # In a unity build the constants of one source shadow nothing that matters in another.
  set(vernier_shadow $<$<NOT:$<BOOL:${CMAKE_UNITY_BUILD}>>:-Wshadow>)
  add_library(${name} ${ARG_SOURCES})
  add_library(vernier::${name} ALIAS ${name})
  target_sources(${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}
                                FILES ${ARG_PUBLIC})
  target_include_directories(${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
  target_compile_features(${name} PUBLIC cxx_std_20)
  # Products and sums are rounded one by one, so that results do not depend on how a compiler
  # pairs them; kernels that gain from fused operations say so themselves.
  set(vernier_module_options
      -Wall -Wextra ${vernier_shadow} -Wnon-virtual-dtor -ffp-contract=off
      # GCC 12 reports faults inside std::string and Eigen that are none
      "$<$<CXX_COMPILER_ID:GNU>:${gcc_false_alarms}>")
  target_compile_options(${name} PRIVATE ${vernier_module_options})
  if(NOT TARGET vernier_headers)
    vernier_module_headers(vernier_headers)
    target_compile_options(vernier_headers PRIVATE ${vernier_module_options})
    set_target_properties(vernier_headers PROPERTIES POSITION_INDEPENDENT_CODE ON)
  endif()
  target_precompile_headers(${name} REUSE_FROM vernier_headers)
  set_target_properties(${name} PROPERTIES OUTPUT_NAME vernier_${name}
                                           POSITION_INDEPENDENT_CODE ON)
  target_link_libraries(${name} PUBLIC Eigen3::Eigen ${ARG_DEPENDS})
  foreach(library IN LISTS ARG_PRIVATE)
    target_link_libraries(${name} PRIVATE ${library})
  endforeach()
  foreach(library IN LISTS ARG_HEADER_ONLY)
    target_include_directories(
      ${name} SYSTEM PRIVATE $<TARGET_PROPERTY:${library},INTERFACE_INCLUDE_DIRECTORIES>)
  endforeach()
  foreach(room IN LISTS ARG_ROOMS)
    add_subdirectory(${room})
  endforeach()
endfunction()

# vernier_simd_sources(NAME FILE …): sources that include themselves once for each instruction set
# (Highway), which they cannot do as a part of a unity build.
function(vernier_simd_sources name)
  set_source_files_properties(${ARGN} TARGET_DIRECTORY ${name}
                              PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ OUTPUT_VARIABLE files)
  set_property(GLOBAL APPEND PROPERTY vernier_simd_sources ${files})
endfunction()
