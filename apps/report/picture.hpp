// Pictures in the page: <img> elements with data: URIs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace vdna::report
{

// A table of numbers to show as shades.
struct Shades {
    size_t rows, columns;
    std::vector<float> values; // [rows][columns]
    double black, white;       // the values shown as black and white; black < white
};

// text: alternative text that describes the picture.
// side: the largest width and height in pixels; larger tables are averaged down.
std::string shades_picture(const Shades &shades, int side, const std::string &text);

// A small JPEG of a picture file, or a sentence that the file can no longer be read.
std::string photo(const std::filesystem::path &file, const std::string &text);

} // namespace vdna::report
