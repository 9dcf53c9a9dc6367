# Fails if LIBRARY calls anything but itself, its lower layer, three functions of <string.h>, and what
# libgcc gives it to choose between vector widths (lib/core/vectorised.h).
execute_process(COMMAND "${NM}" --undefined-only --portability "${LIBRARY}"
  OUTPUT_VARIABLE output RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${NM} cannot read ${LIBRARY}")
endif()
string(REPLACE "\n" ";" lines "${output}")
list(FILTER lines INCLUDE REGEX " U")
list(TRANSFORM lines REPLACE " U.*" "")
foreach(symbol ${lines})
  if(NOT symbol MATCHES "^(memcpy|memset|memcmp|vdna_[a-z0-9_]+|_GLOBAL_OFFSET_TABLE_|__cpu_features2|__cpu_indicator_init)$")
    message(SEND_ERROR "${LIBRARY} calls ${symbol}")
  endif()
endforeach()
