# vernier_image_codecs(LIBRARIES SOURCES): takes opencv_imgcodecs from the list LIBRARIES where it is
# a shared library with the functions that are looked up in it by name, and adds to the list SOURCES
# what calls them. It is then loaded at the first image: Debian's brings a hundred libraries, which
# every start of the program would load, and most verbs read no image. Otherwise (static, one library
# for all of OpenCV, a standard library with other types) it is linked as any other.
include(CheckCXXSourceCompiles)
function(vernier_image_codecs libraries sources)
  check_cxx_source_compiles([[
#include <string>
#if !_GLIBCXX_USE_CXX11_ABI || defined(_GLIBCXX_DEBUG)
#error "strings or vectors of other types than the names below say"
#endif
int main() {}
]] VERNIER_USUAL_STANDARD_LIBRARY)
  set(IMDECODE _ZN2cv8imdecodeERKNS_11_InputArrayEi)
  string(CONCAT IMENCODE _ZN2cv8imencodeERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE
                         RKNS_11_InputArrayERSt6vectorIhSaIhEERKSB_IiSaIiEE)
  set(names "")
  set(SONAME "")
  if(TARGET opencv_imgcodecs)
    get_target_property(type opencv_imgcodecs TYPE)
    get_target_property(configurations opencv_imgcodecs IMPORTED_CONFIGURATIONS)
    string(TOUPPER "${CMAKE_BUILD_TYPE}" configuration)
    if(NOT configuration IN_LIST configurations)
      list(GET configurations 0 configuration)
    endif()
    get_target_property(file opencv_imgcodecs IMPORTED_LOCATION_${configuration})
    get_target_property(SONAME opencv_imgcodecs IMPORTED_SONAME_${configuration})
    if(type STREQUAL "SHARED_LIBRARY" AND EXISTS "${file}")
      file(STRINGS "${file}" names REGEX "^(${IMDECODE}|${IMENCODE})$")
      list(REMOVE_DUPLICATES names)
    endif()
  endif()
  list(LENGTH names found)
  if(found EQUAL 2 AND SONAME AND VERNIER_USUAL_STANDARD_LIBRARY)
    file(CONFIGURE OUTPUT imgcodecs_library.cpp @ONLY CONTENT [[
#include "calib/base/image_codecs.h"
namespace vernier::internal {
const ImgcodecsLibrary imgcodecs_library{"@SONAME@", "@IMDECODE@", "@IMENCODE@"};
}
]])
    set(${sources} loaded_image_codecs.cpp ${CMAKE_CURRENT_BINARY_DIR}/imgcodecs_library.cpp
        PARENT_SCOPE)
    set(VERNIER_LOADED_IMGCODECS ${SONAME} PARENT_SCOPE)
    list(REMOVE_ITEM ${libraries} opencv_imgcodecs)
    set(${libraries} ${${libraries}} PARENT_SCOPE)
  else()
    message(STATUS "OpenCV's image codecs are linked: every start of the program loads them")
    set(${sources} linked_image_codecs.cpp PARENT_SCOPE)
  endif()
endfunction()
