# What a user of libvdna needs, in two components: `runtime` is the shared library, `development`
# the rest. Every path is relative to the prefix, which may be moved as a whole.
include(CMakePackageConfigHelpers)

install(TARGETS vdna_shared vdna_static EXPORT vdna
  LIBRARY COMPONENT runtime NAMELINK_COMPONENT development
  ARCHIVE COMPONENT development
  FILE_SET HEADERS COMPONENT development)
# CMake strips no static library.
install(CODE "
  if(CMAKE_INSTALL_DO_STRIP)
    execute_process(COMMAND \"${CMAKE_STRIP}\" --strip-debug
      \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/$<TARGET_FILE_NAME:vdna_static>\"
      COMMAND_ERROR_IS_FATAL ANY)
  endif()" COMPONENT development)

# CMake: find_package(vdna) gives vdna::vdna (shared) and vdna::static.
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/vdna")
install(EXPORT vdna NAMESPACE vdna:: FILE vdna-config.cmake DESTINATION "${package_dir}"
  COMPONENT development)
# Before 1.0 a minor version may change the API.
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/vdna-config-version.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/vdna-config-version.cmake"
  DESTINATION "${package_dir}" COMPONENT development)

# pkg-config
file(RELATIVE_PATH VDNA_PC_PREFIX "${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig"
  "${CMAKE_INSTALL_PREFIX}")
string(REGEX REPLACE "/$" "" VDNA_PC_PREFIX "${VDNA_PC_PREFIX}")
configure_file("${CMAKE_CURRENT_LIST_DIR}/vdna.pc.in" vdna.pc @ONLY)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/vdna.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig"
  COMPONENT development)

install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}"
  COMPONENT licence)
