// The conditions under which traversals were recorded, as far as their names tell.
#pragma once

#include <string>
#include <vector>

namespace vdna::eval
{

// For each name, what is left without a number at its end ("night" of "night2" and "night_02"); or
// the names themselves, if nothing is left of one, or the same of all.
std::vector<std::string> conditions_of(const std::vector<std::string> &names);

} // namespace vdna::eval
