file(SHA256 ${FILE} found)
if(NOT found STREQUAL SHA256)
  message(FATAL_ERROR "${FILE} has changed: sha256 ${found}, frozen as ${SHA256}")
endif()
