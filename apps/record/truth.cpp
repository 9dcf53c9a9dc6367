#include "record/truth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <vdna/cpp/error.hpp>
#include <vdna/geodesy.h>

namespace vdna::record
{

namespace
{

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double no_altitude_m = 1e-3; // altitudes that are all nearer to 0 are not given

// The positions of one side.
struct Side {
    const double *position; // [frames][3]
    size_t frames;
    bool is_global;

    double altitude(size_t frame) const
    {
        const double *const p = position + 3 * frame;
        double lat = 0, lon = 0, alt = unknown;
        if (!is_global)
            return p[2];
        vdna_geodesy_from_ecef(p, &lat, &lon, &alt);
        return alt;
    }

    bool has_altitudes() const
    {
        for (size_t i = 0; i < frames; i++)
            if (std::abs(altitude(i)) > no_altitude_m)
                return true;
        return false;
    }

    std::vector<double> in_space() const { return {position, position + 3 * frames}; }
};

std::vector<double> ground_of(const Side &side)
{
    return on_the_ground(side.position, side.frames, side.is_global);
}

double places_apart(int64_t a, int64_t b)
{
    if (a == VDNA_PLACE_NONE || b == VDNA_PLACE_NONE)
        return unknown;
    // The difference of two int64 needs the unsigned type.
    const uint64_t high = static_cast<uint64_t>(std::max(a, b));
    return static_cast<double>(high - static_cast<uint64_t>(std::min(a, b)));
}

// name: of the map's experience; may be "".
void require_altitudes_alike(const Side &live, const Side &map, const char *experience)
{
    const std::string map_frames =
        *experience ? "those of " + std::string(experience) : "those of the map";
    const bool has = live.has_altitudes();
    if (has != map.has_altitudes())
        throw Error("--with-altitude: the live frames have " + std::string(has ? "" : "no ") +
                    "altitudes and " + map_frames + " have " + (has ? "none" : "some") +
                    ", expected both or neither; leave out --with-altitude to compare "
                    "horizontally");
}

// Why they are not labelled alike, which they are not.
std::string difference_of(const Recording &live, const vdna_experience &map)
{
    if (live.position.empty() && live.place.empty())
        return "the live frames have no ground truth";
    if (!map.frame_position && !map.frame_place)
        return "the map has no ground truth";
    if (live.position.empty() || !map.frame_position)
        return live.position.empty() ? "live with places, map with positions"
                                     : "live with positions, map with places";
    return "live in frame " + live.position_frame + ", map in " + map.position_frame;
}

} // namespace

const char *name_of(Unit unit)
{
    return unit == Unit::places ? "places" : unit == Unit::metres ? "metres" : "";
}

std::vector<double> on_the_ground(const double *position, size_t frames, bool is_global)
{
    std::vector<double> ground(position, position + 3 * frames);
    for (double *p = ground.data(); p != ground.data() + ground.size(); p += 3)
        if (!is_global)
            p[2] = 0;
        else if (vdna_geodesy_to_ground(p, p) != VDNA_OK)
            std::fill(p, p + 3, unknown);
    return ground;
}

Truth::Truth(const Recording &live, const vdna_experience &map, bool with_altitude)
{
    const bool both = !live.position.empty() && map.frame_position;
    if (both && live.position_frame == map.position_frame) {
        const bool is_global = live.position_frame == VDNA_FRAME_WGS84;
        const Side ours = {live.position.data(), live.frames, is_global},
                   theirs = {map.frame_position, map.frames, is_global};
        if (with_altitude)
            require_altitudes_alike(ours, theirs, map.name);
        unit_ = Unit::metres;
        live_m_ = with_altitude ? ours.in_space() : ground_of(ours);
        map_m_ = with_altitude ? theirs.in_space() : ground_of(theirs);
    } else if (!live.place.empty() && map.frame_place) {
        unit_ = Unit::places;
        live_place_ = live.place.data();
        map_place_ = map.frame_place;
    } else {
        difference_ = difference_of(live, map);
    }
}

bool Truth::knows(size_t live) const
{
    if (unit_ == Unit::places)
        return live_place_[live] != VDNA_PLACE_NONE;
    return unit_ == Unit::metres && !std::isnan(live_m_[3 * live]);
}

double Truth::apart(size_t live, size_t map) const
{
    if (unit_ == Unit::places)
        return places_apart(live_place_[live], map_place_[map]);
    const double *const a = &live_m_[3 * live], *const b = &map_m_[3 * map];
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

} // namespace vdna::record
