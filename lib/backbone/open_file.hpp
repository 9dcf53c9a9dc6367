// Regular files, open for reading.
#pragma once

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>

#include <sys/stat.h>

namespace vdna::backbone
{

class OpenFile
{
  public:
    // A file of at most `limit` bytes. Throws Failure (VDNA_ERR_IO, VDNA_ERR_FORMAT).
    OpenFile(std::filesystem::path file, size_t limit);

    const std::filesystem::path &name() const { return name_; }
    size_t size() const { return static_cast<size_t>(about_.st_size); } // when it was opened
    int descriptor() const { return fileno(stream_.get()); }

    // Read up to `room` bytes, fewer only where the file ends; returns how many.
    // Throws Failure (VDNA_ERR_IO).
    size_t read(char *bytes, size_t room);

    // Throws Failure (VDNA_ERR_IO) if the file may have been written to since it was opened.
    void require_unchanged() const;

  private:
    [[noreturn]] void refused_by_system() const;

    std::filesystem::path name_;
    std::unique_ptr<FILE, int (*)(FILE *)> stream_;
    struct stat about_{};
};

} // namespace vdna::backbone
