#include "test_picture.hpp"

#include <array>

namespace vdna::backbone
{

namespace
{

constexpr uint32_t width = 384, height = 24;

// Red falls from left to right, green stands in tiles, blue is fine texture: no two are alike.
constexpr auto pixels = [] {
    std::array<uint8_t, size_t{3} * width * height> rgb{};
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            const size_t at = 3 * (size_t{y} * width + x);
            rgb[at] = static_cast<uint8_t>(255 - 255 * x / width);
            rgb[at + 1] = (x / 48 + y / 8) % 2 == 0 ? 40 : 180;
            rgb[at + 2] = static_cast<uint8_t>((7 * x + 13 * y) % 100);
        }
    return rgb;
}();

} // namespace

vdna_image test_picture()
{
    return {pixels.data(), pixels.size(), width, height, 0, VDNA_PIXEL_RGB3};
}

} // namespace vdna::backbone
