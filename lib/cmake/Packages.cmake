# Debian packages, by `cmake --build build --target package`: libvdna0, libvdna-dev, vdna-dbgsym and,
# where they are built, libvdna-backbone0, libvdna-backbone-dev, vdna-selectord, vdna-serve, vdna
# and vdna-networks.
# Each is a component of `cmake --install`, from which what only a package has is excluded.
# dpkg-shlibdeps knows the packages of this machine only.
if(CMAKE_CROSSCOMPILING)
  return()
endif()
find_program(VDNA_DPKG_SHLIBDEPS dpkg-shlibdeps)
find_program(VDNA_FILE file) # CPack tells programs from other files by it
find_program(VDNA_GZIP gzip)
mark_as_advanced(VDNA_DPKG_SHLIBDEPS VDNA_FILE VDNA_GZIP)
if(NOT VDNA_DPKG_SHLIBDEPS OR NOT VDNA_FILE OR NOT VDNA_GZIP)
  return()
endif()
set(debian "${CMAKE_CURRENT_LIST_DIR}/debian")
set(made "${CMAKE_CURRENT_BINARY_DIR}/debian")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The vdna authors <maintainers@users.noreply.h-seed-8f829fc0.example>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE
  GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(about "A robot that has several recordings of a route should localise against the
one that looks most like the world does now. vdna finds out which, from
appearance alone, by comparing the activations of a frozen network.
.
This package has")

set(CPACK_COMPONENTS_ALL runtime development debug)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME libvdna${PROJECT_VERSION_MAJOR})
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION libs)
# By hand: CPack would also announce the private ONNX Runtime of vdna-networks.
configure_file("${debian}/shlibs.in" "${made}/shlibs" @ONLY)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA "${debian}/triggers" "${made}/shlibs")
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "${about} the shared library.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libvdna-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
  "libvdna${PROJECT_VERSION_MAJOR} (= ${PROJECT_VERSION}), libmd-dev")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "${about} the headers and the static library.")
set(CPACK_DEBIAN_DEBUG_PACKAGE_NAME vdna-dbgsym)
set(CPACK_DEBIAN_DEBUG_PACKAGE_SECTION debug)
set(CPACK_DEBIAN_DEBUG_PACKAGE_SHLIBDEPS OFF)
set(CPACK_COMPONENT_DEBUG_DESCRIPTION
  "${about} the debug information of the libraries and\nthe programs.")
if(VDNA_BACKBONE)
  list(APPEND CPACK_COMPONENTS_ALL backbone_runtime backbone_development)
  set(CPACK_DEBIAN_BACKBONE_RUNTIME_PACKAGE_NAME libvdna-backbone${PROJECT_VERSION_MAJOR})
  set(CPACK_DEBIAN_BACKBONE_RUNTIME_PACKAGE_SECTION libs)
  configure_file("${debian}/shlibs-backbone.in" "${made}/backbone/shlibs" @ONLY)
  set(CPACK_DEBIAN_BACKBONE_RUNTIME_PACKAGE_CONTROL_EXTRA "${debian}/triggers"
    "${made}/backbone/shlibs")
  set(CPACK_COMPONENT_BACKBONE_RUNTIME_DESCRIPTION
    "${about} the shared library that runs networks, with\nONNX Runtime where that is, or as plug-ins.")
  set(CPACK_DEBIAN_BACKBONE_DEVELOPMENT_PACKAGE_NAME libvdna-backbone-dev)
  set(CPACK_DEBIAN_BACKBONE_DEVELOPMENT_PACKAGE_SECTION libdevel)
  set(CPACK_DEBIAN_BACKBONE_DEVELOPMENT_PACKAGE_DEPENDS
    "libvdna-backbone${PROJECT_VERSION_MAJOR} (= ${PROJECT_VERSION}), libvdna-dev (= ${PROJECT_VERSION})")
  set(CPACK_COMPONENT_BACKBONE_DEVELOPMENT_DESCRIPTION
    "${about} the headers of the library that runs networks.")
endif()
if(VDNA_APPS)
  list(APPEND CPACK_COMPONENTS_ALL daemon serve tool networks)
  set(CPACK_DEBIAN_DAEMON_PACKAGE_NAME vdna-selectord)
  set(CPACK_DEBIAN_DAEMON_PACKAGE_SECTION science)
  set(CPACK_DEBIAN_DAEMON_PACKAGE_DEPENDS "vdna-networks (= ${PROJECT_VERSION})")
  set(CPACK_COMPONENT_DAEMON_DESCRIPTION
    "${about} the daemon, which runs on the robot, and the\nmessages that it speaks.")
  set(CPACK_DEBIAN_SERVE_PACKAGE_NAME vdna-serve)
  set(CPACK_DEBIAN_SERVE_PACKAGE_SECTION science)
  set(CPACK_COMPONENT_SERVE_DESCRIPTION
    "${about} the program that shows a running\ndaemon in a browser.")
  set(CPACK_DEBIAN_TOOL_PACKAGE_NAME vdna)
  set(CPACK_DEBIAN_TOOL_PACKAGE_SECTION science)
  set(CPACK_DEBIAN_TOOL_PACKAGE_DEPENDS "vdna-networks (= ${PROJECT_VERSION})")
  set(CPACK_DEBIAN_TOOL_PACKAGE_RECOMMENDS vdna-serve)
  set(CPACK_COMPONENT_TOOL_DESCRIPTION
    "${about} the command that makes and examines maps.")
  set(CPACK_DEBIAN_NETWORKS_PACKAGE_NAME vdna-networks)
  set(CPACK_DEBIAN_NETWORKS_PACKAGE_SECTION science)
  set(CPACK_COMPONENT_NETWORKS_DESCRIPTION
    "${about} two pretrained networks and ONNX Runtime, which\nruns them.")
endif()

# write a compressed file as Debian wants it, without a time stamp
function(vdna_compress from to)
  execute_process(COMMAND "${VDNA_GZIP}" -9nc "${from}" OUTPUT_FILE "${to}"
    COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# The changelog and the licences of each package.
file(MAKE_DIRECTORY "${made}")
string(TIMESTAMP VDNA_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)
configure_file("${debian}/changelog.in" "${made}/changelog" @ONLY)
vdna_compress("${made}/changelog" "${made}/changelog.gz")
file(READ "${PROJECT_SOURCE_DIR}/LICENSE" VDNA_MIT_TEXT)
string(REGEX REPLACE "^.*authors\n\n" "" VDNA_MIT_TEXT "${VDNA_MIT_TEXT}")
string(REGEX REPLACE "\n\n" "\n.\n" VDNA_MIT_TEXT "${VDNA_MIT_TEXT}")
string(REGEX REPLACE "([^\n]+)\n" " \\1\n" VDNA_MIT_TEXT "${VDNA_MIT_TEXT}")
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  set(VDNA_COPYRIGHT_MORE)
  if(EXISTS "${debian}/copyright-${component}")
    file(READ "${debian}/copyright-${component}" VDNA_COPYRIGHT_MORE)
  endif()
  configure_file("${debian}/copyright.in" "${made}/${component}/copyright" @ONLY)
  install(FILES "${made}/${component}/copyright" "${made}/changelog.gz"
    DESTINATION "share/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME}" COMPONENT ${component}
    EXCLUDE_FROM_ALL)
endforeach()

# What comes with the programs: vdna_package(COMPONENT PAGE) for a manual page NAME.SECTION and the completion
# of the program NAME.
function(vdna_package component page)
  string(REGEX MATCH "^(.*)[.]([0-9])$" matched "${page}")
  set(name "${CMAKE_MATCH_1}")
  set(section "${CMAKE_MATCH_2}")
  add_custom_command(OUTPUT "${VDNA_MADE}/${page}.gz" DEPENDS "${VDNA_MADE}/${page}"
    COMMAND "${VDNA_GZIP}" -9nkf "${VDNA_MADE}/${page}" VERBATIM)
  add_custom_target(manual_${name} ALL DEPENDS "${VDNA_MADE}/${page}.gz")
  add_dependencies(manual_${name} manual)
  set(options COMPONENT ${component} EXCLUDE_FROM_ALL)
  install(FILES "${VDNA_MADE}/${page}.gz" DESTINATION share/man/man${section} ${options})
  install(FILES "${VDNA_MADE}/${name}.bash" DESTINATION share/bash-completion/completions
    RENAME "${name}" ${options})
  install(FILES "${VDNA_MADE}/_${name}" DESTINATION share/zsh/vendor-completions ${options})
endfunction()

# The pages of docs/ but those about the inside, as they are.
foreach(component IN ITEMS daemon tool)
  string(TOUPPER ${component} upper)
  if(VDNA_APPS)
    install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs/"
      DESTINATION "share/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME}"
      COMPONENT ${component} EXCLUDE_FROM_ALL
      FILES_MATCHING PATTERN "*.md" PATTERN "*.svg" PATTERN "*.jpg"
      PATTERN internals EXCLUDE PATTERN man EXCLUDE)
  endif()
endforeach()

if(VDNA_APPS)
  vdna_package(tool vdna.1)
  vdna_package(serve vdna_serve.1)
  vdna_package(daemon vdna_selectord.8)
  install(FILES "${PROJECT_SOURCE_DIR}/apps/selectord/vdna_selectord.service"
    DESTINATION lib/systemd/system COMPONENT daemon EXCLUDE_FROM_ALL)
  # Settings that the user changes, and an upgrade keeps; outside of the prefix, so in a package only.
  install(CODE "
    if(\"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}\" MATCHES \"/_CPack_Packages/\")
      file(INSTALL \"${VDNA_MADE}/vdna.toml\" DESTINATION \"\${CMAKE_INSTALL_PREFIX}/../etc/vdna\")
    endif()" COMPONENT daemon EXCLUDE_FROM_ALL)
  file(WRITE "${made}/conffiles" "/etc/vdna/vdna.toml\n")
  list(APPEND CPACK_DEBIAN_DAEMON_PACKAGE_CONTROL_EXTRA "${made}/conffiles")
endif()

include(CPack)
