# mrcal's C library and the header of CHOLMOD that its Jacobian needs (no function of it is called):
# Mrcal::mrcal. Debian's packages bring no CMake configuration.
find_path(Mrcal_INCLUDE_DIR NAMES mrcal/mrcal.h)
find_path(Mrcal_CHOLMOD_INCLUDE_DIR NAMES cholmod.h PATH_SUFFIXES suitesparse)
find_library(Mrcal_LIBRARY NAMES mrcal)
if(Mrcal_LIBRARY)  # the version is in the name of the file alone: libmrcal.so.2.2
  file(REAL_PATH ${Mrcal_LIBRARY} Mrcal_file)
  string(REGEX REPLACE "^.*\\.so\\.?" "" Mrcal_VERSION "${Mrcal_file}")
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(
  Mrcal
  REQUIRED_VARS Mrcal_LIBRARY Mrcal_INCLUDE_DIR Mrcal_CHOLMOD_INCLUDE_DIR
  VERSION_VAR Mrcal_VERSION
  HANDLE_VERSION_RANGE)
if(Mrcal_FOUND AND NOT TARGET Mrcal::mrcal)
  add_library(Mrcal::mrcal UNKNOWN IMPORTED)
  set_target_properties(
    Mrcal::mrcal PROPERTIES IMPORTED_LOCATION ${Mrcal_LIBRARY}
                            INTERFACE_INCLUDE_DIRECTORIES
                            "${Mrcal_INCLUDE_DIR};${Mrcal_CHOLMOD_INCLUDE_DIR}")
endif()
