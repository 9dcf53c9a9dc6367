# Finds single OpenCV libraries by name: Debian's libopencv-PART-dev packages bring no CMake config,
# and libopencv-dev, which does, pulls in hundreds of packages.
#
#   find_package(OpenCVParts REQUIRED COMPONENTS core imgproc)  ->  OpenCVParts::core, ...
find_path(OpenCVParts_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4)
mark_as_advanced(OpenCVParts_INCLUDE_DIR)

foreach(part IN LISTS OpenCVParts_FIND_COMPONENTS)
  find_library(OpenCVParts_${part}_LIBRARY opencv_${part})
  mark_as_advanced(OpenCVParts_${part}_LIBRARY)
  if(OpenCVParts_INCLUDE_DIR AND OpenCVParts_${part}_LIBRARY
      AND EXISTS "${OpenCVParts_INCLUDE_DIR}/opencv2/${part}.hpp")
    set(OpenCVParts_${part}_FOUND TRUE)
  endif()
endforeach()

list(JOIN OpenCVParts_FIND_COMPONENTS ", " OpenCVParts_wanted)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenCVParts REQUIRED_VARS OpenCVParts_INCLUDE_DIR
  HANDLE_COMPONENTS REASON_FAILURE_MESSAGE
  "install libopencv-PART-dev for each PART of: ${OpenCVParts_wanted}")

foreach(part IN LISTS OpenCVParts_FIND_COMPONENTS)
  if(OpenCVParts_${part}_FOUND AND NOT TARGET OpenCVParts::${part})
    add_library(OpenCVParts::${part} UNKNOWN IMPORTED)
    # Includes of imported targets are SYSTEM: OpenCV's headers do not pass our warnings.
    set_target_properties(OpenCVParts::${part} PROPERTIES
      IMPORTED_LOCATION "${OpenCVParts_${part}_LIBRARY}"
      INTERFACE_INCLUDE_DIRECTORIES "${OpenCVParts_INCLUDE_DIR}")
  endif()
endforeach()
