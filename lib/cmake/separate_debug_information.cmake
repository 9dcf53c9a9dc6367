# At install time: the debug information of each of `binaries`, compressed, below
# ${CMAKE_INSTALL_PREFIX}/lib/debug/.build-id.
foreach(binary IN LISTS binaries)
  execute_process(COMMAND "${readelf}" --notes "${binary}" OUTPUT_VARIABLE notes
    COMMAND_ERROR_IS_FATAL ANY)
  if(NOT notes MATCHES "Build ID: ([0-9a-f][0-9a-f])([0-9a-f]+)")
    message(FATAL_ERROR "${binary}: has no build ID, by which a debugger finds debug information; "
      "configure with -DCMAKE_EXE_LINKER_FLAGS=-Wl,--build-id and "
      "-DCMAKE_SHARED_LINKER_FLAGS=-Wl,--build-id")
  endif()
  set(folder "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/lib/debug/.build-id/${CMAKE_MATCH_1}")
  set(file "${folder}/${CMAKE_MATCH_2}.debug")
  message(STATUS "Installing: ${file}")
  file(MAKE_DIRECTORY "${folder}")
  execute_process(COMMAND "${objcopy}" --only-keep-debug --compress-debug-sections "${binary}"
    "${file}" COMMAND_ERROR_IS_FATAL ANY)
  # It is read and never run.
  file(CHMOD "${file}" PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
endforeach()
