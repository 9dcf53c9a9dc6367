// The track of a drive: where the camera was at any time.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "frames/track_file.hpp"

namespace vdna::frames
{

// Positions over time, straight lines between them.
class Track
{
  public:
    struct Point {
        int64_t utime;                  // microseconds
        std::array<double, 3> position; // metres, Cartesian
    };

    // name: for complaints; frame: of the positions; points: at least one, in any order; of several
    // at the same time the first counts. Points further apart than `gap_us` are not joined.
    Track(const std::string &name, const std::string &frame, std::vector<Point> points,
          int64_t gap_us);

    // Fixes that nobody can have had are left out and told once. Throws Error if none is left.
    static Track of_fixes(const std::string &name, const TrackFile &file, int64_t gap_us);
    // A .gpx file, or a table. Throws Error.
    static Track from_file(const std::filesystem::path &path, int64_t gap_us);

    // The position at a time; nothing before the first point, after the last one, and in a gap.
    std::optional<std::array<double, 3>> at(int64_t utime) const;

    const std::string &name() const { return name_; }
    const std::string &frame() const { return frame_; }
    size_t size() const { return points_.size(); }
    int64_t begin_utime() const { return points_.front().utime; }
    int64_t end_utime() const { return points_.back().utime; }
    int64_t gap_us() const { return gap_us_; }
    // The usual time between two points: the median, in microseconds; 0 for a single point.
    int64_t spacing_us() const;

  private:
    std::string name_, frame_;
    std::vector<Point> points_; // by time, each time once
    int64_t gap_us_;
};

} // namespace vdna::frames
