// Files that appear whole or not at all.
#pragma once

#include <string>

namespace vdna::program
{

// Write a file under another name and rename it when it is complete. Throws Error.
void write_whole_file(const std::string &path, const std::string &bytes);

} // namespace vdna::program
