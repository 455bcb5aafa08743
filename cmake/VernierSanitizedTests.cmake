# The unit tests with address and undefined-behaviour sanitizers, beside those without: the libraries
# are compiled once more for them, in batches, but the tests themselves are not, since it is not
# their code that is to be checked. Half of the time of a second build of everything.
# Without checks of pointer arithmetic, which take a third of the time to compile; an address out of
# range is found when it is used.
set(sanitizer_checks -fsanitize=address,undefined
                     -fno-sanitize=null,alignment,object-size,vptr,pointer-overflow)
add_custom_target(sanitized_tests)

# vernier_sanitized_module(NAME): the sources of a module, as objects.
function(vernier_sanitized_module name)
  get_target_property(sources ${name} SOURCES)
  get_target_property(folder ${name} SOURCE_DIR)
  list(FILTER sources INCLUDE REGEX "[.]cpp$")
  list(FILTER sources EXCLUDE REGEX "cmake_pch")
  list(TRANSFORM sources PREPEND ${folder}/ REGEX "^[^/]")
  add_library(${name}_sanitized OBJECT EXCLUDE_FROM_ALL ${sources})
  target_include_directories(${name}_sanitized
                             PRIVATE $<TARGET_PROPERTY:${name},INCLUDE_DIRECTORIES>)
  # With the assertions of Eigen; without warnings, which the other build gives. Eigen would align
  # its memory itself where addresses are checked, and the tests could not free it.
  set(sanitized_options -ffp-contract=off -O1 -g1 -UNDEBUG -DEIGEN_MALLOC_ALREADY_ALIGNED=1 -w
      ${sanitizer_checks} -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_compile_options(${name}_sanitized PRIVATE ${sanitized_options})
  target_link_libraries(${name}_sanitized PRIVATE $<TARGET_PROPERTY:${name},LINK_LIBRARIES>)
  if(NOT TARGET vernier_sanitized_headers)
    vernier_module_headers(vernier_sanitized_headers)
    target_compile_options(vernier_sanitized_headers PRIVATE ${sanitized_options})
  endif()
  target_precompile_headers(${name}_sanitized REUSE_FROM vernier_sanitized_headers)
  set_target_properties(${name}_sanitized PROPERTIES UNITY_BUILD ON)
  # Kernels for several instruction sets check addresses only: their thousands of temporary packs
  # would take minutes to compile with the other checks.
  get_property(simd_sources GLOBAL PROPERTY vernier_simd_sources)
  set_source_files_properties(
    ${simd_sources} PROPERTIES
    SKIP_UNITY_BUILD_INCLUSION ON
    COMPILE_OPTIONS "-fno-sanitize=undefined;-fno-sanitize-address-use-after-scope")
endfunction()

# vernier_sanitized_test(NAME): the program of tests NAME, linked with such objects. These stand
# first, so that of a function that both have compiled the checked one is used.
function(vernier_sanitized_test name)
  set(program ${name}_sanitized)
  add_executable(
    ${program} EXCLUDE_FROM_ALL
    $<TARGET_OBJECTS:calib_sanitized> $<TARGET_OBJECTS:stereo_sanitized>
    $<TARGET_OBJECTS:localise_sanitized> $<TARGET_OBJECTS:sim_sanitized> $<TARGET_OBJECTS:${name}>)
  target_link_libraries(${program} PRIVATE $<TARGET_PROPERTY:${name},LINK_LIBRARIES> vernier::sim)
  # The sanitized objects come first and win over members of the libraries that a symbol pulls in.
  target_link_options(${program} PRIVATE ${sanitizer_checks} -Wl,--allow-multiple-definition)
  set_target_properties(${program} PROPERTIES LINKER_LANGUAGE CXX)
  add_dependencies(${program} ${name})
  add_dependencies(sanitized_tests ${program})

  file(STRINGS ${PROJECT_SOURCE_DIR}/tests/sanitizer_exclusions.txt excluded REGEX "^[^#]")
  list(JOIN excluded ":" excluded)
  vernier_sharded_test(${program} sanitized "GTEST_FILTER=-${excluded}")
endfunction()
