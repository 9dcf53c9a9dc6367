// Pictures within the page: <img> elements with data: URIs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace vdna::report
{

// A table of numbers to be shown as shades.
struct Shades {
    size_t rows, columns;
    std::vector<float> values; // [rows][columns]
    double black, white;       // the values that are shown so; black < white
};

// text: what the picture shows, for those who cannot see it.
// side: the largest width and height in pixels; what is larger is averaged down.
std::string shades_picture(const Shades &shades, int side, const std::string &text);

// A small JPEG of a picture file; where that cannot be read any more, a sentence that says so.
std::string photo(const std::filesystem::path &file, const std::string &text);

} // namespace vdna::report
