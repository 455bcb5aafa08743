# Installation: headers in include/vernier, the libraries with a CMake package whose components are
# the modules (vernier::calib …), and in share/vernier what the program needs to find.
if(NOT PROJECT_IS_TOP_LEVEL)
  return()
endif()
include(CMakePackageConfigHelpers)
set(vernier_components calib stereo localise sim)  # each brings those to its left
set(vernier_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/vernier)

# vernier_dependencies(MODULE RESULT): the find_dependency lines for what a module links, and for
# nothing else. Stops where it links a package that is not listed here: who uses the installed
# library could not find it.
function(vernier_dependencies module result)
  get_target_property(needs ${module} INTERFACE_LINK_LIBRARIES)
  # An installed static library asks for what it links privately as $<LINK_ONLY:package>.
  list(TRANSFORM needs REPLACE "^\\$<LINK_ONLY:(.+)>$" "\\1")
  list(FILTER needs EXCLUDE REGEX "^vernier::")  # brought by the component itself
  list(REMOVE_ITEM needs ${CMAKE_DL_LIBS})        # of the C library
  set(lines "")
  foreach(package IN ITEMS "Eigen3::|Eigen3 3.4" "Ceres::|Ceres 2.1" "fmt::|fmt"
                           "Highway::|Highway" "LibYAML::|LibYAML" "TBB::|TBB" "SQLite::|SQLite3"
                           "JPEG::|JPEG" "PNG::|PNG")
    string(REPLACE "|" ";" package "${package}")
    list(GET package 0 namespace)
    list(GET package 1 arguments)
    set(others ${needs})
    list(FILTER others EXCLUDE REGEX "^${namespace}")
    if(NOT "${others}" STREQUAL "${needs}")
      string(APPEND lines "  find_dependency(${arguments})\n")
    endif()
    set(needs ${others})
  endforeach()
  set(parts ${needs})
  list(FILTER parts INCLUDE REGEX "^opencv_")
  list(FILTER needs EXCLUDE REGEX "^opencv_")
  if(parts)
    list(REMOVE_DUPLICATES parts)
    list(TRANSFORM parts REPLACE "^opencv_" "")
    set(version 4.6)
    if(VERNIER_LOADED_IMGCODECS)  # by its name at run time: it must be the one that core belongs to
      list(APPEND parts imgcodecs)
      set(version "${OpenCV_VERSION} EXACT")
    endif()
    list(JOIN parts " " parts)
    string(APPEND lines "  find_dependency(OpenCV ${version} COMPONENTS ${parts})\n")
  endif()
  if(needs)
    message(FATAL_ERROR "${module} links ${needs}, and vernier_dependencies in "
                        "cmake/VernierInstall.cmake does not know the package to find for it: add "
                        "it to the list there, or link it as HEADER_ONLY")
  endif()
  set(${result} "${lines}" PARENT_SCOPE)
endfunction()

# One set of targets a component; the package file reads those that are asked for.
set(VERNIER_READ_COMPONENTS "")
foreach(component IN LISTS vernier_components)
  install(TARGETS ${component} EXPORT vernier_${component}_targets
          FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/vernier)
  install(EXPORT vernier_${component}_targets NAMESPACE vernier::
          DESTINATION ${vernier_package_dir})
  vernier_dependencies(${component} dependencies)
  string(APPEND VERNIER_READ_COMPONENTS
         "if(\"${component}\" IN_LIST vernier_wanted)\n${dependencies}"
         "  include(\${CMAKE_CURRENT_LIST_DIR}/vernier_${component}_targets.cmake)\n"
         "  set(vernier_${component}_FOUND TRUE)\nendif()\n")
endforeach()
list(JOIN vernier_components " " VERNIER_COMPONENTS)
configure_package_config_file(cmake/vernier-config.cmake.in vernier-config.cmake
                              INSTALL_DESTINATION ${vernier_package_dir}
                              NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(vernier-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/vernier-config.cmake
              ${PROJECT_BINARY_DIR}/vernier-config-version.cmake cmake/FindHighway.cmake
              cmake/FindLibYAML.cmake
        DESTINATION ${vernier_package_dir})

# The program finds these beside itself, in ../share/vernier; cli/page adds the report's page.
set(vernier_share_dir ${CMAKE_INSTALL_DATADIR}/vernier)
install(DIRECTORY datasets/worlds datasets/rigs datasets/studies DESTINATION ${vernier_share_dir})
install(FILES python/mrcal_uncertainty.py DESTINATION ${vernier_share_dir}/python)
