// Files with the track of a GPS receiver.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace vdna::frames
{

// A position of the receiver.
struct Fix {
    int64_t utime;             // microseconds since 1970
    double lat, lon;           // WGS84 degrees, not checked
    std::optional<double> alt; // metres
};

// The fixes of a file, in its order.
struct TrackFile {
    std::vector<Fix> fixes;
    uint64_t unplaced = 0; // points without a time or a position
};

// The track points of a .gpx file, of all tracks and segments. Throws Error.
TrackFile read_gpx(const std::filesystem::path &path);

// A table with the columns utime (microseconds) or time (ISO 8601, or a number of seconds,
// milliseconds, microseconds or nanoseconds since 1970), lat, lon and possibly alt, or as phones
// spell them: "Timestamp", "Latitude", "Longitude (°)", "elevation". Throws Error with file and
// line.
TrackFile read_track_table(const std::filesystem::path &path);

} // namespace vdna::frames
