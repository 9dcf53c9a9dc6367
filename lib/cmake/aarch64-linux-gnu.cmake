# Toolchain: Debian's cross compilers for 64-bit ARM, and qemu to run what they make.
#
#   cmake --preset core --toolchain lib/cmake/aarch64-linux-gnu.cmake -DCMAKE_SYSROOT=SYSROOT
#
# Libraries and headers are those under CMAKE_SYSROOT (./dev aarch64 makes one). Without it they are
# those that `apt-get install NAME:arm64` puts beside the system's own.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)

if(CMAKE_SYSROOT AND NOT IS_DIRECTORY "${CMAKE_SYSROOT}")
  message(FATAL_ERROR "CMAKE_SYSROOT: there is no folder ${CMAKE_SYSROOT}; expected the root of an "
    "arm64 system's files; ./dev aarch64 makes build/aarch64/sysroot")
endif()

# No notes that GCC before 10.1 passed some arguments otherwise.
set(CMAKE_CXX_FLAGS_INIT -Wno-psabi)

# Generators such as lcm-gen run here; all else that is found must be the target's.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
foreach(kind IN ITEMS LIBRARY INCLUDE PACKAGE)
  set(CMAKE_FIND_ROOT_PATH_MODE_${kind} ONLY)
endforeach()

# The processor of a Raspberry Pi 5, and where its programs find the C library.
set(libraries "${CMAKE_SYSROOT}")
if(NOT libraries)
  set(libraries /usr/aarch64-linux-gnu)
endif()
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64 -cpu cortex-a76 -L "${libraries}")
