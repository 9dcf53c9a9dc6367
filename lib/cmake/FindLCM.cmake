# FindLCM - the library as lcm::lcm, the code generator as lcm::lcm-gen.
# A module of our own because Debian's LCM 1.3.1 has no CMake files and a pkg-config file that asks
# for GLib's headers, which its own headers do not need. The target names are those of LCM 1.5.
# For an LCM elsewhere set CMAKE_PREFIX_PATH, as usual.
find_path(LCM_INCLUDE_DIR lcm/lcm.h)
find_library(LCM_LIBRARY lcm)
# First the lcm-gen of the same LCM: with `pip install lcm` there is another one on the path, whose
# C++ does not compile with the headers of 1.3.1.
cmake_path(GET LCM_INCLUDE_DIR PARENT_PATH _lcm_prefix)
find_program(LCM_GEN_EXECUTABLE lcm-gen PATHS "${_lcm_prefix}/bin" NO_DEFAULT_PATH)
find_program(LCM_GEN_EXECUTABLE lcm-gen)
mark_as_advanced(LCM_INCLUDE_DIR LCM_LIBRARY LCM_GEN_EXECUTABLE)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(LCM
  REQUIRED_VARS LCM_LIBRARY LCM_INCLUDE_DIR LCM_GEN_EXECUTABLE
  REASON_FAILURE_MESSAGE "on Debian: apt-get install liblcm-dev liblcm-bin")

if(LCM_FOUND AND NOT TARGET lcm::lcm)
  # Include directories of imported targets are system directories: no warnings from them.
  add_library(lcm::lcm UNKNOWN IMPORTED)
  set_target_properties(lcm::lcm PROPERTIES
    IMPORTED_LOCATION "${LCM_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES "${LCM_INCLUDE_DIR}")
  add_executable(lcm::lcm-gen IMPORTED)
  set_target_properties(lcm::lcm-gen PROPERTIES IMPORTED_LOCATION "${LCM_GEN_EXECUTABLE}")
endif()
