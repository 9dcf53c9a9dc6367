// Experience files by path: those of a map directory, or single ones.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <vdna/cpp/experience.hpp>

namespace vdna::record
{

// The experience files of a map directory in the order of their names, unopened.
std::vector<std::filesystem::path> experience_files(const std::filesystem::path &map);

// Open the files; a map directory means all of its files. They need not compare.
std::vector<Experience> open_experiences(const std::vector<std::string> &paths);

} // namespace vdna::record
