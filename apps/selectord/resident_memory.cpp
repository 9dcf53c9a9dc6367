#include "selectord/resident_memory.hpp"

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

namespace vdna::selectord
{

namespace
{

// The value of "KEY:   123 kB".
int64_t bytes_of(const char *text, const char *key)
{
    const char *line = std::strstr(text, key);
    int64_t kilobytes;
    // NOLINTNEXTLINE(*-string-to-number-conversion,cert-err34-c): the kernel writes what fits
    return line && std::sscanf(line + std::strlen(key), ": %" SCNd64, &kilobytes) == 1
               ? kilobytes * 1024
               : 0;
}

} // namespace

ResidentMemory::ResidentMemory() : ResidentMemory(getpid()) {}

ResidentMemory::ResidentMemory(pid_t process)
{
    char path[32];
    std::snprintf(path, sizeof path, "/proc/%d/status", static_cast<int>(process));
    file_ = open(path, O_RDONLY | O_CLOEXEC);
}

ResidentMemory::~ResidentMemory()
{
    if (file_ >= 0)
        close(file_);
}

Resident ResidentMemory::read() const
{
    char text[4096];
    const ssize_t size = pread(file_, text, sizeof text - 1, 0);
    if (size <= 0)
        return {};
    text[size] = '\0';
    const int64_t now = bytes_of(text, "VmRSS");
    // The system updates the high-water mark less often than the value.
    return {now, bytes_of(text, "RssAnon"), std::max(now, bytes_of(text, "VmHWM"))};
}

} // namespace vdna::selectord
