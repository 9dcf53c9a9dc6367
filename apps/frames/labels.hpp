// Labels of frames (time, place, position): a CSV table with one row per picture or frame.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace vdna::frames
{

// The label of one frame.
struct Label {
    std::optional<int64_t> utime;                  // camera stamp, microseconds
    std::optional<int64_t> place;                  // place number
    std::optional<std::array<double, 3>> position; // metres, Cartesian; ECEF if made from GPS
};

// The rows of one CSV file. Columns: `file` (relative to the CSV's folder) or `frame` (index from
// 0), and `place`, or `x,y[,z]` in metres, or `lat,lon[,alt]` in WGS84 degrees and metres, or
// `utime`. Others are ignored.
class Labels
{
  public:
    // Throws Error with file and line if a row breaks these rules.
    explicit Labels(const std::filesystem::path &csv);

    // The row of a frame, identified by its index and, for a picture, its path ("" otherwise).
    // Throws Error if there is none.
    const Label &find(const std::filesystem::path &file, uint64_t frame) const;

    // Files in `folder` or below that rows are about, other than `files`, which are in the folder.
    std::vector<std::filesystem::path>
    others_below(const std::filesystem::path &folder,
                 const std::vector<std::filesystem::path> &files) const;

    // The stamps of a table that numbers frames, in the order of these numbers.
    std::vector<int64_t> frame_utimes() const;

    // One more than the largest frame number; 0 for a table of files.
    uint64_t numbered_frames() const;

  private:
    std::string csv_;
    bool by_file_ = false;
    std::map<std::string, Label> rows_; // by resolved path, or by index
};

// Convert WGS84 latitude and longitude in degrees and height above the ellipsoid in metres to
// Earth-centred, Earth-fixed metres, so that distances need no zone.
std::array<double, 3> ecef_of(double lat_deg, double lon_deg, double alt_m);

} // namespace vdna::frames
