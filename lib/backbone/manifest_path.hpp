// Where manifests are found.
#pragma once

#include <filesystem>
#include <string>

namespace vdna::backbone
{

// The manifest that `wanted` means: itself if it holds a '/' or ends in ".toml", else
// DIRECTORY/wanted.toml of the first of these that has it: $VDNA_MODELS, the installation
// of the running program, /usr/share/vdna/models.
// Throws Failure (VDNA_ERR_IO) that says where it looked and what is there.
std::filesystem::path find_manifest(const std::string &wanted);

} // namespace vdna::backbone
