#include "selectord/resident_memory.hpp"

#include <cinttypes>
#include <cstdio>

#include <fcntl.h>
#include <unistd.h>

namespace vdna
{

ResidentMemory::ResidentMemory() : file_(open("/proc/self/statm", O_RDONLY | O_CLOEXEC)) {}

ResidentMemory::~ResidentMemory()
{
    if (file_ >= 0)
        close(file_);
}

int64_t ResidentMemory::bytes() const
{
    char text[128];
    const ssize_t size = pread(file_, text, sizeof text - 1, 0);
    if (size <= 0)
        return 0;
    text[size] = '\0';
    int64_t pages; // the second number: resident
    return std::sscanf(text, "%*d %" SCNd64, &pages) == 1 ? pages * sysconf(_SC_PAGESIZE) : 0;
}

} // namespace vdna
