// Which positions of a table nobody can have been at: they are left out, counted and told.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace vdna::frames
{

// Why a position is left out.
enum class Flaw { incomplete, not_a_number, at_zero, off_the_globe, jump, unplaced, repeated };

// A position with its time, to find jumps.
struct TimedPosition {
    size_t row;
    std::string drive; // positions compare within one
    int64_t stamp;     // in any unit of vdna/camera_time.h, the same within a drive
    std::array<double, 3> ground_m;
};

// A receiver's leaps: the rows of positions that are reached from the last one and left for the
// next one faster than 100 m/s, 25 m of noise allowed, while those two are within reach of one
// another. At most 10 positions in a row, so that a drive that really goes on elsewhere is kept, as
// are the first and the last ones, of which nobody can tell which is wrong.
std::vector<size_t> jumps_among(std::vector<TimedPosition> positions);

// WGS84 degrees and metres that a vehicle can have: on the globe, 12 km below to 100 km above the
// ellipsoid, and not exactly at 0,0, which receivers without a fix report.
std::optional<Flaw> flaw_of_fix(double lat_deg, double lon_deg, double alt_m);

// "4 fixes left out: 3 at 0,0, 1 beyond the globe"; "" if there are none.
std::string text_of(const std::map<Flaw, size_t> &left_out);

} // namespace vdna::frames
