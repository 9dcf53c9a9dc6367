# debug - the debug information of what is installed, in a component of its own that is installed only
# if it is asked for. It lies where gdb looks, by build ID: PREFIX/lib/debug/.build-id. The installed
# programs may lack theirs (`cmake --install --strip`, packages) or not.
set(binaries "$<TARGET_FILE:vdna_shared>")
if(VDNA_BACKBONE)
  list(APPEND binaries "$<TARGET_FILE:vdna_backbone_shared>")
endif()
if(VDNA_APPS)
  list(APPEND binaries "$<TARGET_FILE:vdna>" "$<TARGET_FILE:vdna_selectord>"
    "$<TARGET_FILE:vdna_serve>")
endif()
install(CODE "
  set(binaries \"${binaries}\")
  set(readelf \"${CMAKE_READELF}\")
  set(objcopy \"${CMAKE_OBJCOPY}\")
  include(\"${CMAKE_CURRENT_LIST_DIR}/separate_debug_information.cmake\")"
  COMPONENT debug EXCLUDE_FROM_ALL)
