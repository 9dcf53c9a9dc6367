# amalgamation - core, health, localise, trust and select, which need nothing, as one vdna.c and one vdna.h in
# BUILD/amalgamation, and beside them freestanding/, the two headers that it needs where there is no C
# library; installed as share/vdna/amalgamation. Identity and map stay out: they need libmd and POSIX, and so a build system
# anyway.
block()
  set(inputs)
  foreach(part core health localise trust select)
    get_target_property(sources vdna_${part} SOURCES)
    get_target_property(source_dir vdna_${part} SOURCE_DIR)
    list(TRANSFORM sources PREPEND "${source_dir}/")
    list(APPEND inputs ${sources})
  endforeach()
  list(APPEND inputs ${VDNA_HEADERS})
  list(FILTER inputs EXCLUDE REGEX "/(experience_localise|geodesy|identity|map|map_trust)\\.h$")

  set(output "${PROJECT_BINARY_DIR}/amalgamation")
  file(MAKE_DIRECTORY "${output}")
  set(freestanding "${CMAKE_CURRENT_LIST_DIR}/freestanding")
  if(VDNA_PYTHON)
    set(amalgamate "${VDNA_PYTHON}" -B "${CMAKE_CURRENT_LIST_DIR}/amalgamate.py" ${PROJECT_VERSION}
      "${output}" ${inputs})
    add_custom_target(amalgamation VERBATIM
      COMMAND ${amalgamate}
      COMMAND "${CMAKE_COMMAND}" -E copy_directory "${freestanding}" "${output}/freestanding")
  endif()
  if(VDNA_PYTHON AND VDNA_INSTALL)
    # Written when it is installed, so that it need not be built each time.
    list(JOIN amalgamate "\" \"" amalgamate)
    install(CODE "execute_process(COMMAND \"${amalgamate}\" COMMAND_ERROR_IS_FATAL ANY)"
      COMPONENT development)
    set(folder "${CMAKE_INSTALL_DATADIR}/vdna/amalgamation")
    install(FILES "${output}/vdna.c" "${output}/vdna.h" DESTINATION "${folder}"
      COMPONENT development)
    install(FILES "${freestanding}/math.h" "${freestanding}/string.h"
      DESTINATION "${folder}/freestanding" COMPONENT development)
  endif()
endblock()
