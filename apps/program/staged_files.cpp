#include "program/staged_files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <vdna/cpp/error.hpp>

namespace vdna::program
{

namespace
{

namespace fs = std::filesystem;

fs::path part_of(const fs::path &file)
{
    return file.string() + ".part";
}

// Makes the names in a directory reach the disk.
void sync_directory(const fs::path &path)
{
    const int directory = open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (directory < 0)
        return;
    fsync(directory);
    close(directory);
}

} // namespace

StagedFiles::StagedFiles(const fs::path &map) : map_(map)
{
    std::error_code failure;
    made_map_ = fs::create_directories(map, failure);
    if (failure)
        throw Error(map.string() + ": cannot make this directory: " + failure.message());
}

StagedFiles::~StagedFiles()
{
    std::error_code unused;
    for (const fs::path &file : files_)
        fs::remove(part_of(file), unused);
    if (made_map_)
        fs::remove(map_, unused);
}

void StagedFiles::write(const vdna_experience &experience, const fs::path &file)
{
    vdna_error error{};
    require(vdna_experience_write(&experience, part_of(file).c_str(), &error), error);
    // Not earlier: what was in the way of a failed write is not ours to remove.
    files_.push_back(file);
}

void StagedFiles::commit()
{
    for (const fs::path &file : files_)
        fs::rename(part_of(file), file);
    files_.clear();
    made_map_ = false;
    sync_directory(map_);
}

} // namespace vdna::program
