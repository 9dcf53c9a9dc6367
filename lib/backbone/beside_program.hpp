// Files that were installed together with the running program.
#pragma once

#include <filesystem>

namespace vdna::backbone
{

// `relative` to the folder of the running program; empty if the system does not say where that is.
std::filesystem::path beside_program(const char *relative);

} // namespace vdna::backbone
