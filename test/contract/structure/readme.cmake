# Fails unless the README shows apps/examples/choose.c to the letter.
file(READ "${ROOT}/README.md" readme)
file(READ "${ROOT}/apps/examples/choose.c" example)
string(FIND "${readme}" "```c\n${example}```" place)
if(place EQUAL -1)
  message(FATAL_ERROR "README.md does not show apps/examples/choose.c as it is; copy it there")
endif()
