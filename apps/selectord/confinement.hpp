// What the process of a network may not do. Each call of these is for ever.
#pragma once

#include <cstdint>

#include <sys/types.h>

namespace vdna::selectord
{

// End this process with its parent, at once if that is not `parent` any more.
void end_with(pid_t parent);

// No file of this process grows, and it leaves no core file. Writing to one is an error then.
void forbid_file_growth();

// Let the address space grow by so many bytes from here.
void limit_growth(uint64_t bytes);

// From here on all threads may compute, allocate, read files and start threads; every other system
// call fails with EPERM: sockets, files opened for writing, programs, processes, signals to others.
// False, with errno, if the system cannot do that.
bool forbid_system_calls();

} // namespace vdna::selectord
