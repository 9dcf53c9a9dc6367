// Names of pictures that say where and when they were taken:
//   @UTM_EAST@UTM_NORTH@ZONE@LETTER@LAT@LON@PANORAMA@TILE@HEADING@PITCH@ROLL@HEIGHT@TIME@NOTE@.jpg
// Fields after the second may be empty or missing, and so may the last '@'.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace vdna::frames
{

// The texts of the fields that are of use here; "" = missing.
struct UtmName {
    std::string east;
    std::string north;
    std::string zone;
    std::string time;
};

bool is_utm_name(const std::filesystem::path &file); // begins with '@'
UtmName utm_name_of(const std::filesystem::path &file);

// Stamp of a time field: microseconds for YYYYMMDDhhmmss (UTC); as it is for a number of 9 digits
// or more; otherwise nothing, because a date alone is no time.
std::optional<int64_t> stamp_of(const std::string &time);

} // namespace vdna::frames
