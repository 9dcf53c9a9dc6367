#include "vdna/position_json.hpp"

#include <cmath>

#include <vdna/cpp/experience.hpp>
#include <vdna/geodesy.h>

namespace vdna::tool
{

namespace
{

// What doubles of Earth-centred metres hold: more digits are noise. Without -0.
double rounded(double value, double digits)
{
    return std::round(value * digits) / digits + 0.0;
}

} // namespace

std::array<const char *, 3> axes_of(const std::string &frame)
{
    if (frame == VDNA_FRAME_WGS84)
        return {"lat", "lon", "alt"};
    return {"x", "y", "z"};
}

std::array<double, 3> as_it_came(const double *position, const std::string &frame)
{
    if (frame != VDNA_FRAME_WGS84)
        return {position[0], position[1], position[2]};
    double lat = 0, lon = 0, alt = 0; // cannot fail: a valid file has positions near the globe
    vdna_geodesy_from_ecef(position, &lat, &lon, &alt);
    return {rounded(lat, 1e10), rounded(lon, 1e10), rounded(alt, 1e5)};
}

program::Json position_json(const double *position, const std::string &frame)
{
    program::Json json = {{"frame", frame}};
    const std::array<const char *, 3> axes = axes_of(frame);
    const std::array<double, 3> numbers = as_it_came(position, frame);
    for (size_t i = 0; i < 3; i++)
        json[axes[i]] = numbers[i];
    return json;
}

} // namespace vdna::tool
