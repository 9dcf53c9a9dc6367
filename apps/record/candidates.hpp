// Picking experiences of a map by name.
#pragma once

#include <string>
#include <vector>

#include <vdna/cpp/map.hpp>

namespace vdna::record
{

// Indices of the named experiences in the order of the map. Throws Error for an unknown name.
std::vector<size_t> named_in(const Map &map, const std::vector<std::string> &names);

// Indices of all the others.
std::vector<size_t> all_but(const Map &map, const std::vector<std::string> &names);

} // namespace vdna::record
