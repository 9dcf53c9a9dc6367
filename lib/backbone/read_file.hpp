// Whole files in memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace vdna::backbone
{

// The bytes of a file of at most `limit` bytes. Throws Failure (VDNA_ERR_IO, VDNA_ERR_FORMAT).
std::string read_file(const std::filesystem::path &file, size_t limit);

} // namespace vdna::backbone
