// Files that were installed together with the running program, or, where this code is in a shared
// library, with that.
#pragma once

#include <filesystem>

namespace vdna::backbone
{

// `relative` to the folder of the installation's programs; empty if the system does not say where
// that is.
std::filesystem::path beside_program(const char *relative);

} // namespace vdna::backbone
