// Several experience files that appear in a map together or not at all.
#pragma once

#include <filesystem>
#include <vector>

#include <vdna/map.h>

namespace vdna::program
{

// Files written under another name until commit(); gone if that is never reached.
class StagedFiles
{
  public:
    // Makes the map directory if it does not exist. Throws Error.
    explicit StagedFiles(const std::filesystem::path &map);
    ~StagedFiles();
    StagedFiles(const StagedFiles &) = delete;
    StagedFiles &operator=(const StagedFiles &) = delete;

    // file: where it will be after commit(). Throws Error.
    void write(const vdna_experience &experience, const std::filesystem::path &file);
    void commit();

  private:
    std::filesystem::path map_;
    bool made_map_;
    std::vector<std::filesystem::path> files_;
};

} // namespace vdna::program
