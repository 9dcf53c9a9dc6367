#include "vdna/experience_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "frames/iso_time.hpp"
#include "program/text_table.hpp"
#include "record/truth.hpp"

namespace vdna::tool
{

namespace
{

std::pair<int64_t, int64_t> times_of(const vdna_experience &e)
{
    const auto [first, last] = std::minmax_element(e.frame_utime, e.frame_utime + e.frames);
    return {*first, *last};
}

// Metres along the frames that have a position.
double route_of(const vdna_experience &e)
{
    const std::vector<double> m = record::on_the_ground(
        e.frame_position, e.frames, std::strcmp(e.position_frame, VDNA_FRAME_WGS84) == 0);
    double length = 0;
    const double *before = nullptr;
    for (size_t i = 0; i < e.frames; i++) {
        const double *const here = &m[3 * i];
        if (std::isnan(here[0]))
            continue;
        if (before)
            length += std::hypot(here[0] - before[0], here[1] - before[1], here[2] - before[2]);
        before = here;
    }
    return length;
}

size_t places_of(const vdna_experience &e)
{
    std::set<int64_t> places(e.frame_place, e.frame_place + e.frames);
    places.erase(VDNA_PLACE_NONE);
    return places.size();
}

std::string route_text(const vdna_experience &e)
{
    if (e.frame_position)
        return program::fixed(route_of(e), 0) + " m";
    return e.frame_place ? std::to_string(places_of(e)) + " places" : "-";
}

// "2024-05-01 10:00:00 to 10:12:30"; without dates, how long it took.
std::string time_text(const vdna_experience &e)
{
    constexpr size_t day = 10, second = 19; // characters up to there
    const auto [first, last] = times_of(e);
    std::string from = frames::date_of(first), to = frames::date_of(last);
    if (from.empty() || to.empty())
        return program::fixed(static_cast<double>(last - first) / 1e6, 1) + " s, no date";
    from[day] = to[day] = ' ';
    const bool is_same_day = from.compare(0, day, to, 0, day) == 0;
    return from.substr(0, second) + " to " +
           (is_same_day ? to.substr(day + 1, second - day - 1) : to.substr(0, second));
}

uint32_t thumbnails_of(const vdna_experience &e)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < e.frames; i++)
        count += !thumbnail_of(e, i).empty();
    return count;
}

} // namespace

program::Json look_of(const vdna_experience &e)
{
    const auto [first, last] = times_of(e);
    program::Json dates;
    if (!frames::date_of(first).empty() && !frames::date_of(last).empty())
        dates = {frames::date_of(first), frames::date_of(last)};
    return {{"source", e.source},
            {"dates", dates},
            {"route_m", e.frame_position ? program::Json(route_of(e)) : program::Json()},
            {"thumbnails", thumbnails_of(e)},
            {"thumbnail_bytes", e.thumbnail_bytes}};
}

std::string experience_table(const std::vector<Experience> &files)
{
    program::TextTable table;
    table.add_row({"experience", "frames", "time (UTC)", "route", "thumbnails", "size", "source"});
    for (const Experience &file : files) {
        const vdna_experience &e = *file.get();
        const uint32_t thumbnails = thumbnails_of(e);
        table.add_row({e.name, std::to_string(e.frames), time_text(e), route_text(e),
                       thumbnails == 0          ? "none"
                       : thumbnails == e.frames ? "all"
                                                : std::to_string(thumbnails),
                       program::fixed(static_cast<double>(e.file_size) / (1 << 20), 1) + " MiB",
                       e.source[0] != '\0' ? e.source : "-"});
    }
    return table.text();
}

} // namespace vdna::tool
