# vdna_build_flags - how our own code is compiled; linked privately, so users never inherit it.
add_library(vdna_build_flags INTERFACE)
target_compile_options(vdna_build_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow
  $<$<COMPILE_LANGUAGE:C>:-Wstrict-prototypes>
  # The same counts must give the same bits on every machine: no fused multiply-add.
  -ffp-contract=off
  $<$<BOOL:${VDNA_WERROR}>:-Werror>
  # Lines for a backtrace, no variables: in full, those of CLI11, JSON and Eigen are a third of the
  # compiler's time and most of a program's size. The C part keeps all, for abidw and for size;
  # CMAKE_BUILD_TYPE=Debug has all.
  $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<CONFIG:RelWithDebInfo>>:-g1>)
if(VDNA_SANITIZE)
  target_compile_options(vdna_build_flags INTERFACE -fsanitize=${VDNA_SANITIZE}
    -fno-sanitize-recover=all -fno-omit-frame-pointer
    # Looks at memory through a pipe, which the network's process may not make.
    $<$<COMPILE_LANGUAGE:CXX>:-fno-sanitize=vptr>)
  # PUBLIC to every executable: a sanitized library needs its runtime at link time.
  add_link_options(-fsanitize=${VDNA_SANITIZE})
endif()

# vdna_includes_toml(SOURCE): toml++ marks as unreachable what a letter beyond ASCII outside a string
# reaches (its issues 190 and 295); compiled, it is not taken for a blank, as should be. Tests check that.
function(vdna_includes_toml source)
  if(VDNA_SANITIZE)
    set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS -fno-sanitize=unreachable)
  endif()
endfunction()

# vdna_hardening - what an overrun meets in our programs, and in the libraries that take files, pictures
# and messages. The rest of the C99 part calls nothing, so neither __stack_chk_fail() nor __memcpy_chk().
add_library(vdna_hardening INTERFACE)
target_compile_options(vdna_hardening INTERFACE -fstack-protector-strong)
# Needs optimisation, and has no place beside a sanitizer, which sees more.
if(NOT VDNA_SANITIZE)
  target_compile_options(vdna_hardening INTERFACE
    "$<$<CONFIG:Release,RelWithDebInfo,MinSizeRel>:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=3>")
endif()

# vdna_program(TARGET): compile and link an executable as those that are installed.
include(CheckPIESupported)
check_pie_supported() # not every compiler makes them position-independent by itself
function(vdna_program target)
  target_link_libraries(${target} PRIVATE vdna_build_flags vdna_hardening)
  # Not of vdna_hardening: through a static library, programs of others would inherit it.
  target_link_options(${target} PRIVATE LINKER:-z,relro,-z,now)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
endfunction()

# Settings that all our libraries share. HARDENED: with vdna_hardening.
function(vdna_library target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "HARDENED" "ALIAS;OUTPUT_NAME" "HEADERS")
  add_library(vdna::${arg_ALIAS} ALIAS ${target})
  target_sources(${target} PUBLIC FILE_SET HEADERS
    BASE_DIRS "${PROJECT_SOURCE_DIR}/lib/include" FILES ${arg_HEADERS})
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:vdna_build_flags>)
  if(arg_HARDENED)
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:vdna_hardening>)
  endif()
  set_target_properties(${target} PROPERTIES
    OUTPUT_NAME ${arg_OUTPUT_NAME} EXPORT_NAME ${arg_ALIAS}
    C_STANDARD 99 C_EXTENSIONS OFF CXX_STANDARD 17 CXX_STANDARD_REQUIRED ON CXX_EXTENSIONS OFF
    C_VISIBILITY_PRESET hidden CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
    POSITION_INDEPENDENT_CODE ON)
endfunction()
