// Positions in JSON, as they came: WGS84 as degrees, local ones as metres.
#pragma once

#include <array>
#include <string>

#include "program/print.hpp"

namespace vdna::tool
{

// The names of the three numbers in a frame: lat, lon, alt, or x, y, z.
std::array<const char *, 3> axes_of(const std::string &frame);

// The three numbers of a position of a file, which is not NaN.
std::array<double, 3> as_it_came(const double *position, const std::string &frame);

// {"frame": "wgs84", "lat": ..., "lon": ..., "alt": ...}
program::Json position_json(const double *position, const std::string &frame);

} // namespace vdna::tool
