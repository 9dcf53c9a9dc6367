# Fails unless the README shows apps/examples/first.c to the letter.
file(READ "${ROOT}/README.md" readme)
file(READ "${ROOT}/apps/examples/first.c" example)
string(FIND "${readme}" "```c\n${example}```" place)
if(place EQUAL -1)
  message(FATAL_ERROR "README.md does not show apps/examples/first.c as it is; copy it there")
endif()
