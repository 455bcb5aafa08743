# Installation: headers in include/vernier, the libraries with a CMake package (vernier::calib …),
# and in share/vernier what the program needs to find.
if(NOT PROJECT_IS_TOP_LEVEL)
  return()
endif()
include(CMakePackageConfigHelpers)
set(vernier_modules calib stereo localise sim)
set(vernier_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/vernier)

# A library that is headers only leaves nothing to link, and no installed header shows it: whoever
# uses the package need not have it.
foreach(module IN LISTS vernier_modules)
  get_target_property(interface ${module} INTERFACE_LINK_LIBRARIES)
  list(REMOVE_ITEM interface $<LINK_ONLY:nlohmann_json::nlohmann_json>
                             $<LINK_ONLY:Random123::Random123>)
  set_property(TARGET ${module} PROPERTY INTERFACE_LINK_LIBRARIES ${interface})
  list(APPEND vernier_needs ${interface})
endforeach()

# The package asks for what the libraries link, and for nothing else.
set(VERNIER_FIND_DEPENDENCIES "find_dependency(Eigen3 3.4)\n")
foreach(package IN ITEMS "Ceres::|Ceres 2.1" "fmt::|fmt" "TBB::|TBB" "SQLite::|SQLite3"
                         "tomlplusplus::|tomlplusplus" "spdlog::|spdlog" "Highway::|Highway"
                         "yaml-cpp|yaml-cpp" "JPEG::|JPEG" "PNG::|PNG")
  string(REPLACE "|" ";" package "${package}")
  list(GET package 0 namespace)
  list(GET package 1 arguments)
  if(vernier_needs MATCHES "${namespace}")
    string(APPEND VERNIER_FIND_DEPENDENCIES "find_dependency(${arguments})\n")
  endif()
endforeach()
if(vernier_needs MATCHES "opencv_")
  string(REGEX MATCHALL "opencv_[a-z0-9]+" components "${vernier_needs}")
  list(REMOVE_DUPLICATES components)
  list(TRANSFORM components REPLACE "^opencv_" "")
  list(JOIN components " " components)
  string(APPEND VERNIER_FIND_DEPENDENCIES
         "find_dependency(OpenCV 4.6 COMPONENTS ${components})\n")
endif()

install(TARGETS ${vernier_modules} EXPORT vernier_targets
        FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/vernier)
install(EXPORT vernier_targets NAMESPACE vernier:: DESTINATION ${vernier_package_dir})
configure_package_config_file(cmake/vernier-config.cmake.in vernier-config.cmake
                              INSTALL_DESTINATION ${vernier_package_dir}
                              NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(vernier-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/vernier-config.cmake
              ${PROJECT_BINARY_DIR}/vernier-config-version.cmake cmake/FindHighway.cmake
        DESTINATION ${vernier_package_dir})

# The program finds these beside itself, in ../share/vernier. Without the plots, which npm brings,
# the report's page holds tables only.
set(vernier_share_dir ${CMAKE_INSTALL_DATADIR}/vernier)
install(DIRECTORY datasets/worlds datasets/rigs DESTINATION ${vernier_share_dir})
install(FILES python/mrcal_uncertainty.py DESTINATION ${vernier_share_dir}/python)
install(DIRECTORY cli/page/js DESTINATION ${vernier_share_dir}/page)
install(FILES cli/page/report.html cli/page/report.css DESTINATION ${vernier_share_dir}/page)
install(FILES cli/page/node_modules/plotly.js-cartesian-dist-min/plotly-cartesian.min.js
        DESTINATION ${vernier_share_dir}/page OPTIONAL)
