# amalgamation - core, health, localise, trust and select, which need nothing, as one vdna.c and one vdna.h in
# BUILD/amalgamation. Identity and map stay out: they need libmd and POSIX, and so a build system
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
  if(VDNA_PYTHON)
    add_custom_target(amalgamation VERBATIM
      COMMAND "${VDNA_PYTHON}" "${CMAKE_CURRENT_LIST_DIR}/amalgamate.py" ${PROJECT_VERSION}
        "${output}" ${inputs})
  endif()
endblock()
