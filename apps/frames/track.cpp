#include "frames/track.hpp"

#include <algorithm>
#include <cctype>

#include <vdna/cpp/error.hpp>

#include "frames/labels.hpp"
#include "frames/track_file.hpp"

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

// Earth-centred. Heights count only if every fix has one: with some of them 0 the track would leap.
std::vector<Track::Point> points_of(const std::vector<Fix> &fixes)
{
    const bool has_heights =
        std::all_of(fixes.begin(), fixes.end(), [](const Fix &fix) { return fix.alt.has_value(); });
    std::vector<Track::Point> points;
    for (const Fix &fix : fixes)
        points.push_back({fix.utime, ecef_of(fix.lat, fix.lon, has_heights ? *fix.alt : 0)});
    return points;
}

} // namespace

Track::Track(const std::string &name, std::vector<Point> points, int64_t gap_us)
    : name_(name), points_(std::move(points)), gap_us_(gap_us)
{
    std::stable_sort(points_.begin(), points_.end(),
                     [](const Point &a, const Point &b) { return a.utime < b.utime; });
    const auto at_the_same_time = [](const Point &a, const Point &b) { return a.utime == b.utime; };
    points_.erase(std::unique(points_.begin(), points_.end(), at_the_same_time), points_.end());
}

Track Track::from_file(const std::filesystem::path &path, int64_t gap_us)
{
    const TrackFile file = is_gpx(path) ? read_gpx(path) : read_track_table(path);
    return Track(path.string(), points_of(file.fixes), gap_us);
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
    if (steps.empty())
        return 0;
    std::nth_element(steps.begin(), steps.begin() + static_cast<ptrdiff_t>(steps.size() / 2),
                     steps.end());
    return steps[steps.size() / 2];
}

} // namespace vdna::frames
