#include "frames/time_axis.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "program/median.hpp"

namespace vdna::frames
{

namespace
{

// Frames of a drive are not as far apart as this, microseconds.
constexpr double spacing_us_max = 5e6;

std::string seconds(double us)
{
    return program::fixed(us / 1e6, 1) + " s";
}

bool stand_still(const std::vector<int64_t> &stamps)
{
    return stamps.size() > 1 && std::all_of(stamps.begin(), stamps.end(),
                                            [&](int64_t s) { return s == stamps.front(); });
}

// The median distance in time of frames that follow one another, microseconds.
double median_spacing(const std::vector<int64_t> &stamps, uint32_t unit)
{
    std::vector<double> spacings;
    for (size_t i = 1; i < stamps.size(); i++)
        spacings.push_back(std::abs(static_cast<double>(vdna_time_us(unit, stamps[i])) -
                                    static_cast<double>(vdna_time_us(unit, stamps[i - 1]))));
    return program::median_of(std::move(spacings));
}

uint32_t unit_of(const std::vector<int64_t> &stamps, uint32_t unit)
{
    if (unit == VDNA_TIME_UNIT_AUTO)
        unit = vdna_time_unit(stamps.data(), stamps.size());
    return unit == VDNA_TIME_UNIT_AUTO ? uint32_t{VDNA_TIME_UNIT_US} : unit;
}

} // namespace

TimeAxis::TimeAxis(const std::vector<int64_t> &stamps, uint32_t unit, int64_t late_us)
    : has_stamps_(!stamps.empty())
{
    vdna_camera_time_init(&time_, unit_of(stamps, unit), late_us);
    if (time_.unit != VDNA_TIME_UNIT_US && unit == VDNA_TIME_UNIT_AUTO)
        notes_.push_back(std::string("its stamps are ") + vdna_time_unit_name(time_.unit) +
                         ", converted to microseconds");
    if (stand_still(stamps))
        notes_.push_back("camera time stands still: all " + std::to_string(stamps.size()) +
                         " stamps are " + std::to_string(stamps.front()));
    const double spacing = median_spacing(stamps, time_.unit);
    if (spacing >= spacing_us_max)
        notes_.push_back("its frames are " + seconds(spacing) +
                         " apart by their stamps; if the stamps are nanoseconds, set "
                         "--time-unit ns");
}

std::optional<int64_t> TimeAxis::take(int64_t stamp)
{
    const int64_t before = time_.newest_us;
    int64_t utime = 0;
    const uint32_t order = vdna_camera_time_take(&time_, stamp, &utime);
    frames_++;
    if (order == VDNA_TIME_LATE)
        return {};
    if (order == VDNA_TIME_BACKWARDS && time_.backwards == 1)
        notes_.push_back("camera time steps back by " +
                         seconds(static_cast<double>(before) - static_cast<double>(utime)) +
                         " at frame " + std::to_string(frames_ - 1));
    return utime;
}

void TimeAxis::describe(Account &account) const
{
    account.time_unit = has_stamps_ ? vdna_time_unit_name(time_.unit) : "";
    account.late = time_.late;
    account.notes.insert(account.notes.end(), notes_.begin(), notes_.end());
    if (time_.backwards > 1)
        account.notes.push_back("camera time steps back " + std::to_string(time_.backwards) +
                                " times in all");
}

} // namespace vdna::frames
