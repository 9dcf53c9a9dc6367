// A file in memory with a path, for readers of files: nothing is written to a disk.
#pragma once

#include <cstdlib>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

#include "fuzz.h"

class MemoryFile
{
  public:
    MemoryFile() : descriptor_(memfd_create("fuzz", MFD_CLOEXEC))
    {
        if (descriptor_ < 0)
            std::abort();
        path_ = "/proc/self/fd/" + std::to_string(descriptor_);
    }
    MemoryFile(const MemoryFile &) = delete;
    MemoryFile &operator=(const MemoryFile &) = delete;
    ~MemoryFile() { close(descriptor_); }

    const std::string &path() const { return path_; }

    // Replace the contents.
    void hold(const void *bytes, size_t size)
    {
        if (ftruncate(descriptor_, 0) != 0 ||
            pwrite(descriptor_, bytes, size, 0) != static_cast<ssize_t>(size))
            std::abort();
    }

  private:
    int descriptor_;
    std::string path_;
};
