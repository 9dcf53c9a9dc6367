// Folders that appear when everything in them is there.
#pragma once

#include <filesystem>

namespace vdna::program
{

// A folder to work in, PATH.partial, which becomes PATH when it is finished and goes away
// otherwise.
class NewFolder
{
  public:
    // Throws Error, std::filesystem::filesystem_error.
    explicit NewFolder(const std::filesystem::path &path);
    ~NewFolder();
    NewFolder(const NewFolder &) = delete;
    NewFolder &operator=(const NewFolder &) = delete;

    // Where to work.
    const std::filesystem::path &partial() const { return partial_; }
    // Replaces what bears the name. Throws std::filesystem::filesystem_error.
    void finish();

  private:
    std::filesystem::path path_, partial_;
};

} // namespace vdna::program
