#include "frames/track.hpp"

#include <algorithm>
#include <cctype>
#include <functional>
#include <map>
#include <utility>

#include <vdna/cpp/error.hpp>
#include <vdna/geodesy.h>
#include <vdna/map.h>

#include "frames/fixes.hpp"
#include "program/median.hpp"
#include "program/notice.hpp"

namespace vdna::frames
{

namespace
{

bool is_gpx(const std::filesystem::path &path)
{
    std::string ending = path.extension().string();
    for (char &c : ending)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return ending == ".gpx";
}

std::array<double, 3> ecef_of(const Fix &fix, double height)
{
    std::array<double, 3> ecef{};
    vdna_geodesy_to_ecef(fix.lat, fix.lon, height, ecef.data());
    return ecef;
}

// The fixes that someone can have had.
std::vector<Fix> sound_fixes(const std::vector<Fix> &fixes, std::map<Flaw, size_t> &left_out)
{
    std::vector<Fix> sound;
    std::vector<TimedPosition> timed;
    for (const Fix &fix : fixes) {
        if (const std::optional<Flaw> flaw = flaw_of_fix(fix.lat, fix.lon, fix.alt.value_or(0))) {
            left_out[*flaw]++;
            continue;
        }
        timed.push_back({sound.size(), "", fix.utime, ecef_of(fix, 0)});
        sound.push_back(fix);
    }
    std::vector<size_t> jumps = jumps_among(timed);
    std::sort(jumps.begin(), jumps.end(), std::greater<>());
    for (const size_t jump : jumps)
        sound.erase(sound.begin() + static_cast<ptrdiff_t>(jump));
    if (!jumps.empty())
        left_out[Flaw::jump] = jumps.size();
    return sound;
}

// Heights count only if every fix has one: with some of them 0 the track would leap.
std::vector<Track::Point> points_of(const std::vector<Fix> &fixes)
{
    const bool has_heights =
        std::all_of(fixes.begin(), fixes.end(), [](const Fix &fix) { return fix.alt.has_value(); });
    std::vector<Track::Point> points;
    for (const Fix &fix : fixes)
        points.push_back({fix.utime, ecef_of(fix, has_heights ? *fix.alt : 0)});
    return points;
}

} // namespace

Track::Track(const std::string &name, const std::string &frame, std::vector<Point> points,
             int64_t gap_us)
    : name_(name), frame_(frame), points_(std::move(points)), gap_us_(gap_us)
{
    std::stable_sort(points_.begin(), points_.end(),
                     [](const Point &a, const Point &b) { return a.utime < b.utime; });
    const auto at_the_same_time = [](const Point &a, const Point &b) { return a.utime == b.utime; };
    points_.erase(std::unique(points_.begin(), points_.end(), at_the_same_time), points_.end());
}

Track Track::of_fixes(const std::string &name, const TrackFile &file, int64_t gap_us)
{
    std::map<Flaw, size_t> left_out;
    if (file.unplaced > 0)
        left_out[Flaw::unplaced] = file.unplaced;
    const std::vector<Fix> fixes = sound_fixes(file.fixes, left_out);
    if (fixes.empty())
        throw Error(name + ": no fix of this track can be used: " + text_of(left_out) +
                    "; record it again under the open sky");
    Track track(name, VDNA_FRAME_WGS84, points_of(fixes), gap_us);
    if (const size_t repeated = fixes.size() - track.size())
        left_out[Flaw::repeated] = repeated;
    if (!left_out.empty())
        program::tell_once(name + ": " + text_of(left_out));
    return track;
}

Track Track::from_file(const std::filesystem::path &path, int64_t gap_us)
{
    return of_fixes(path.string(), is_gpx(path) ? read_gpx(path) : read_track_table(path), gap_us);
}

std::optional<std::array<double, 3>> Track::at(int64_t utime) const
{
    const auto after =
        std::lower_bound(points_.begin(), points_.end(), utime,
                         [](const Point &point, int64_t time) { return point.utime < time; });
    if (after == points_.end())
        return {};
    if (after->utime == utime)
        return after->position;
    if (after == points_.begin())
        return {};
    const Point &a = after[-1], &b = *after;
    const int64_t apart_us = b.utime - a.utime;
    if (apart_us > gap_us_)
        return {};
    const double share = static_cast<double>(utime - a.utime) / static_cast<double>(apart_us);
    std::array<double, 3> position;
    for (size_t i = 0; i < 3; i++)
        position[i] = a.position[i] + share * (b.position[i] - a.position[i]);
    return position;
}

int64_t Track::spacing_us() const
{
    std::vector<int64_t> steps;
    for (size_t i = 1; i < points_.size(); i++)
        steps.push_back(points_[i].utime - points_[i - 1].utime);
    return program::median_of(std::move(steps));
}

} // namespace vdna::frames
