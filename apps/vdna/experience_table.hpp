// The experiences of a map as a table, one line for each.
#pragma once

#include <string>
#include <vector>

#include <vdna/cpp/experience.hpp>

#include "program/print.hpp"

namespace vdna::tool
{

// What the JSON of one experience says beside its file's own numbers: "source", "dates" (of the
// first and the last frame, ISO 8601, null if its stamps are no dates), "route_m" (null without
// positions), "thumbnails" (frames that have one), "thumbnail_bytes".
program::Json look_of(const vdna_experience &experience);

// Lines for a terminal, with a head.
std::string experience_table(const std::vector<Experience> &files);

} // namespace vdna::tool
