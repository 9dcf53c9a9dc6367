// The methods that rank references: one table of their names and distances.
#pragma once

#include <string>
#include <vector>

#include "eval/evaluation.hpp"

namespace vdna::eval
{

// A query's warmup and one reference, for a method to compare.
struct Comparison {
    const record::Recording &live;
    uint32_t begin, frames; // of the warmup, in `live`
    const record::Recording &map;
    double distance_bins; // of the Visual DNAs
};

struct Method {
    const char *key;   // in JSON, CSV and file names
    const char *title; // for people
    const char *unit;  // of the distance
    // NULL: no distance; the metrics are exact expectations over all rankings. Throws Error.
    double (*distance)(const Comparison &comparison);
};

// Ours first, chance last.
extern const std::vector<Method> methods;

// Visual DNA of one tap is also a method, "vdna:TAP", with the same distance.
std::string key_of_tap(const std::string &tap);
bool is_of_tap(const std::string &key);

// Title and unit of the method with this key; an unknown key is its own title, without a unit.
std::string title_of(const std::string &key);
std::string unit_of(const std::string &key);

} // namespace vdna::eval
