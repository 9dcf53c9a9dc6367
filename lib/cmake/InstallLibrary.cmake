# What a user of our libraries needs. libvdna is the components `runtime` (the shared library) and
# `development` (the rest); libvdna_backbone is backbone_runtime and backbone_development. Every path is
# relative to the prefix, which may be moved as a whole.
include(CMakePackageConfigHelpers)

# vdna_install_library(TARGETS PART): the files of one library, PART is "" for libvdna. CMake finds its
# targets in vdna-PART-targets.cmake, pkg-config in vdna-PART.pc.
function(vdna_install_library targets part)
  set(name vdna)
  set(component)
  if(part)
    set(name vdna-${part})
    set(component ${part}_)
  endif()
  install(TARGETS ${targets} EXPORT ${name}
    LIBRARY COMPONENT ${component}runtime NAMELINK_COMPONENT ${component}development
    ARCHIVE COMPONENT ${component}development
    FILE_SET HEADERS COMPONENT ${component}development)
  install(EXPORT ${name} NAMESPACE vdna:: FILE ${name}-targets.cmake
    DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/vdna" COMPONENT ${component}development)

  file(RELATIVE_PATH VDNA_PC_PREFIX "${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig"
    "${CMAKE_INSTALL_PREFIX}")
  string(REGEX REPLACE "/$" "" VDNA_PC_PREFIX "${VDNA_PC_PREFIX}")
  configure_file("${PROJECT_SOURCE_DIR}/lib/cmake/${name}.pc.in" ${name}.pc @ONLY)
  install(FILES "${CMAKE_CURRENT_BINARY_DIR}/${name}.pc"
    DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT ${component}development)
endfunction()

# find_package(vdna) gives vdna::vdna (shared) and vdna::static; with the component backbone also
# vdna::backbone.
vdna_install_library("vdna_shared;vdna_static" "")
# CMake strips no static library.
install(CODE "
  if(CMAKE_INSTALL_DO_STRIP)
    execute_process(COMMAND \"${CMAKE_STRIP}\" --strip-debug
      \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/$<TARGET_FILE_NAME:vdna_static>\"
      COMMAND_ERROR_IS_FATAL ANY)
  endif()" COMPONENT development)
# Before 1.0 a minor version may change the API.
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/vdna-config-version.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_LIST_DIR}/vdna-config.cmake"
  "${CMAKE_CURRENT_BINARY_DIR}/vdna-config-version.cmake"
  DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/vdna" COMPONENT development)

install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}"
  COMPONENT licence)
