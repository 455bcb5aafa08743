# vernier_module(NAME HEADERS … SOURCES … DEPENDS … PRIVATE …)
# One static (or shared) library vernier::NAME whose headers are included as "NAME/header.h", in
# the tree and after installation alike. DEPENDS are the modules to its left; PRIVATE libraries
# never appear in its headers.
function(vernier_module name)
  set(gcc_false_alarms -Wno-restrict -Wno-stringop-overflow -Wno-maybe-uninitialized)
  cmake_parse_arguments(ARG "" "" "HEADERS;SOURCES;DEPENDS;PRIVATE" ${ARGN})
  add_library(${name} ${ARG_SOURCES})
  add_library(vernier::${name} ALIAS ${name})
  target_sources(${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}
                                FILES ${ARG_HEADERS})
  target_include_directories(${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
  target_compile_features(${name} PUBLIC cxx_std_20)
  # Products and sums are rounded one by one, so that results do not depend on how a compiler
  # pairs them; kernels that gain from fused operations say so themselves.
  target_compile_options(${name} PRIVATE -Wall -Wextra -Wshadow -Wnon-virtual-dtor
                                         -ffp-contract=off
                                         # GCC 12 reports faults inside std::string and Eigen
                                         # that are none
                                         "$<$<CXX_COMPILER_ID:GNU>:${gcc_false_alarms}>")
  target_precompile_headers(${name} PRIVATE <Eigen/Core> <Eigen/Geometry> <Eigen/LU>)
  set_target_properties(${name} PROPERTIES OUTPUT_NAME vernier_${name}
                                           POSITION_INDEPENDENT_CODE ON)
  target_link_libraries(${name} PUBLIC Eigen3::Eigen ${ARG_DEPENDS})
  foreach(library IN LISTS ARG_PRIVATE)
    target_link_libraries(${name} PRIVATE ${library})
  endforeach()
endfunction()
