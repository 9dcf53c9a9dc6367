// Folders that appear only when they are complete.
#pragma once

#include <filesystem>

namespace vdna::program
{

// A working folder, PATH.partial, which becomes PATH when it is finished and is deleted otherwise.
class NewFolder
{
  public:
    // Throws Error, std::filesystem::filesystem_error.
    explicit NewFolder(const std::filesystem::path &path);
    ~NewFolder();
    NewFolder(const NewFolder &) = delete;
    NewFolder &operator=(const NewFolder &) = delete;

    // The working folder.
    const std::filesystem::path &partial() const { return partial_; }
    // Rename it to PATH, replacing an existing one. Throws std::filesystem::filesystem_error.
    void finish();

  private:
    std::filesystem::path path_, partial_;
};

} // namespace vdna::program
