// Pictures in the report, as bytes of picture files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace vdna::report
{

// A table of numbers to show as shades.
struct Shades {
    size_t rows, columns;
    std::vector<float> values; // [rows][columns]
    double black, white;       // the values shown as black and white; black < white
};

struct Encoded {
    std::vector<uint8_t> bytes; // empty if there is no picture
    int columns = 0, rows = 0;  // pixels
};

// A grey PNG. side: the largest width and height in pixels; larger tables are averaged down.
Encoded shades_png(const Shades &shades, int side);

// A small JPEG of a picture file; empty if the file can no longer be read.
Encoded photo_jpeg(const std::filesystem::path &file);

// A thumbnail as experience files have it, as it is; empty if it is no picture.
Encoded thumbnail_jpeg(std::string_view jpeg);

} // namespace vdna::report
