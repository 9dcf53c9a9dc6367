#include "program/new_folder.hpp"

namespace vdna::program
{

namespace fs = std::filesystem;

NewFolder::NewFolder(const fs::path &path) : path_(path), partial_(path)
{
    partial_ += ".partial";
    fs::remove_all(partial_);
    fs::create_directories(partial_);
}

NewFolder::~NewFolder()
{
    std::error_code ignored;
    fs::remove_all(partial_, ignored);
}

void NewFolder::finish()
{
    fs::remove_all(path_);
    fs::rename(partial_, path_);
}

} // namespace vdna::program
