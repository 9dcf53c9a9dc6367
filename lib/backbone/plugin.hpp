// Networks of others: tables of operations, and the shared libraries that bring them.
#pragma once

#include <string>

#include <vdna/backbone.h>

namespace vdna::backbone
{

// Whether `manifest` means a plug-in: a path with a '/' that ends in ".so".
// Throws Failure (VDNA_ERR_ARG) for a name that ends so and has no '/'.
bool is_plugin(const std::string &manifest);

// A copy of a table that can be used. `whose` begins the sentence if it cannot: a path, say.
// Throws Failure (VDNA_ERR_UNSUPPORTED).
vdna_backbone_operations checked(const vdna_backbone_operations *table, const std::string &whose);

// The checked table of a plug-in. The library stays loaded until the process ends.
// Throws Failure (VDNA_ERR_IO, VDNA_ERR_UNSUPPORTED).
vdna_backbone_operations load_plugin(const std::string &path);

} // namespace vdna::backbone
