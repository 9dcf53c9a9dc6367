# Fails if the daemon links a library that a robot would not have: what it links, it installs.
set(allowed "libjpeg|liblcm|libmd|libstdc\\+\\+|libgcc_s|libm|libc|ld-linux[^.]*|libasan|libubsan")
execute_process(COMMAND "${READELF}" --dynamic "${DAEMON}"
  OUTPUT_VARIABLE output RESULT_VARIABLE result)
if(NOT result EQUAL 0 OR NOT output MATCHES "NEEDED")
  message(FATAL_ERROR "${READELF} cannot read ${DAEMON}")
endif()
# A bracket would keep CMake from taking the lines apart.
string(REPLACE "[" "" output "${output}")
string(REPLACE "]" "" output "${output}")
string(REGEX MATCHALL "NEEDED[^\n]*" lines "${output}")
foreach(line IN LISTS lines)
  string(REGEX REPLACE ".* " "" library "${line}")
  if(NOT library MATCHES "^(${allowed})\\.so")
    message(SEND_ERROR "${DAEMON} links ${library}; expected none but ${allowed}")
  endif()
endforeach()
