# Builds for finding faults, never for use: everything is compiled with instruments. Both of them are
# unity builds of preset build folders (CMakePresets.json); scripts/fuzz.sh and
# scripts/thread_sanitizer.sh make and run them.
if(VERNIER_BUILD_FUZZ AND VERNIER_THREAD_SANITIZER)
  message(FATAL_ERROR "the fuzz targets and the thread sanitizer need a build folder each")
endif()

# Assertions of the standard library, of Eigen and of the JSON and TOML libraries stay on. Eigen would
# align its memory itself where addresses are checked.
if(VERNIER_BUILD_FUZZ OR VERNIER_THREAD_SANITIZER)
  add_compile_options(-O1 -g1 -UNDEBUG -w -fno-omit-frame-pointer)
  add_compile_definitions(EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()

# As in cmake/VernierSanitizedTests.cmake, without the checks that take a third of the time to compile;
# and with the check of conversions of numbers that are out of an integer's range.
if(VERNIER_BUILD_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL Clang)
    message(FATAL_ERROR "the fuzz targets need clang++ (libFuzzer): use --preset fuzz")
  endif()
  add_compile_definitions(_GLIBCXX_ASSERTIONS)
  add_compile_options(-gline-tables-only
                      -fsanitize=fuzzer-no-link,address,undefined,float-cast-overflow
                      -fno-sanitize=null,alignment,object-size,vptr,pointer-overflow
                      -fno-sanitize-recover=all)
  add_link_options(-fsanitize=address,undefined)
endif()
if(VERNIER_THREAD_SANITIZER)
  add_compile_options(-fsanitize=thread)
  add_link_options(-fsanitize=thread)
endif()

# To be called after all modules: kernels for several instruction sets take minutes to compile with
# every check, and read no file.
function(vernier_lighten_simd_sources)
  if(VERNIER_BUILD_FUZZ)
    get_property(simd_sources GLOBAL PROPERTY vernier_simd_sources)
    foreach(module IN ITEMS calib stereo localise sim)
      set_property(SOURCE ${simd_sources} TARGET_DIRECTORY ${module} APPEND
                   PROPERTY COMPILE_OPTIONS -fno-sanitize=undefined,float-cast-overflow,fuzzer-no-link)
      set_source_files_properties(${simd_sources} TARGET_DIRECTORY ${module}
                                  PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
    endforeach()
  endif()
endfunction()
