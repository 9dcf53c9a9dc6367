#include "frames/fixes.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <vdna/camera_time.h>

namespace vdna::frames
{

namespace
{

constexpr double fastest_m_per_s = 100, noise_m = 25;
constexpr size_t longest_leap = 10; // positions
constexpr double lowest_m = -12000, highest_m = 100000;

bool is_a_jump(const TimedPosition &a, const TimedPosition &b)
{
    const double seconds = (static_cast<double>(b.stamp) - static_cast<double>(a.stamp)) / 1e6;
    const double apart = std::hypot(a.ground_m[0] - b.ground_m[0], a.ground_m[1] - b.ground_m[1],
                                    a.ground_m[2] - b.ground_m[2]);
    return apart > noise_m + fastest_m_per_s * seconds;
}

// Where the drive goes on after a leap to `begin`; `begin` if it does not come back.
size_t end_of_leap(const std::vector<TimedPosition> &drive, size_t begin)
{
    const size_t last = std::min(begin + longest_leap, drive.size() - 1);
    for (size_t i = begin + 1; i <= last; i++)
        if (is_a_jump(drive[i - 1], drive[i]) && !is_a_jump(drive[begin - 1], drive[i]))
            return i;
    return begin;
}

void add_jumps(const std::vector<TimedPosition> &drive, std::vector<size_t> &rows)
{
    for (size_t i = 1; i < drive.size(); i++) {
        if (!is_a_jump(drive[i - 1], drive[i]))
            continue;
        for (const size_t end = end_of_leap(drive, i); i < end; i++)
            rows.push_back(drive[i].row);
    }
}

const char *text_of(Flaw flaw)
{
    switch (flaw) {
    case Flaw::incomplete:
        return " with half of a position";
    case Flaw::not_a_number:
        return " without a number";
    case Flaw::at_zero:
        return " at 0,0";
    case Flaw::off_the_globe:
        return " beyond the globe";
    case Flaw::jump:
        return " where no vehicle gets in the time";
    case Flaw::unplaced:
        return " without a time or a position";
    case Flaw::repeated:
        break;
    }
    return " at the time of another";
}

// The positions of one drive, in order of time.
std::vector<TimedPosition> in_microseconds(std::vector<TimedPosition> drive)
{
    std::vector<int64_t> stamps;
    for (const TimedPosition &position : drive)
        stamps.push_back(position.stamp);
    const uint32_t unit = vdna_time_unit(stamps.data(), stamps.size());
    for (TimedPosition &position : drive)
        position.stamp = vdna_time_us(unit, position.stamp);
    return drive;
}

} // namespace

std::vector<size_t> jumps_among(std::vector<TimedPosition> positions)
{
    std::stable_sort(positions.begin(), positions.end(),
                     [](const TimedPosition &a, const TimedPosition &b) {
                         return std::tie(a.drive, a.stamp) < std::tie(b.drive, b.stamp);
                     });
    std::vector<size_t> rows;
    for (auto begin = positions.begin(); begin != positions.end();) {
        const auto end = std::find_if(begin, positions.end(), [&](const TimedPosition &p) {
            return p.drive != begin->drive;
        });
        add_jumps(in_microseconds({begin, end}), rows);
        begin = end;
    }
    return rows;
}

std::optional<Flaw> flaw_of_fix(double lat_deg, double lon_deg, double alt_m)
{
    if (lat_deg == 0 && lon_deg == 0)
        return Flaw::at_zero;
    if (std::abs(lat_deg) > 90 || std::abs(lon_deg) > 360 || alt_m < lowest_m || alt_m > highest_m)
        return Flaw::off_the_globe;
    return {};
}

std::string text_of(const std::map<Flaw, size_t> &left_out)
{
    size_t all = 0;
    std::string parts;
    for (const auto &[flaw, count] : left_out) {
        all += count;
        parts += (parts.empty() ? "" : ", ") + std::to_string(count) + text_of(flaw);
    }
    return all == 0 ? ""
                    : std::to_string(all) + (all == 1 ? " fix" : " fixes") + " left out: " + parts;
}

} // namespace vdna::frames
