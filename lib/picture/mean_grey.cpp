#include "mean_grey.hpp"

#include <array>

#include "vectorised.h"

namespace vdna::picture
{

namespace
{

// A multiple of 1, 3 and 4, so that each sum belongs to one channel, and enough to fill any vector.
constexpr size_t lanes = 192;
// 32 bits hold the sums of a whole picture: each adds at most this many bytes.
static_assert((VDNA_IMAGE_PIXELS_MAX / lanes * 4 + VDNA_IMAGE_SIDE_MAX) <= UINT32_MAX / 255);

VDNA_VECTORISED void add_row(const uint8_t *row, size_t bytes, uint32_t *sums)
{
    for (; bytes >= lanes; bytes -= lanes, row += lanes)
        for (size_t i = 0; i < lanes; i++)
            sums[i] += row[i];
    for (size_t i = 0; i < bytes; i++)
        sums[i] += row[i];
}

// Sum of each channel over all pixels.
std::array<uint64_t, 4> sums_of(const vdna_pixels &pixels)
{
    std::array<uint32_t, lanes> sums{};
    for (uint32_t y = 0; y < pixels.height; y++)
        add_row(pixels.data + y * pixels.stride, size_t{pixels.width} * pixels.channels,
                sums.data());
    std::array<uint64_t, 4> total{};
    for (size_t i = 0; i < lanes; i++)
        total[i % pixels.channels] += sums[i];
    return total;
}

} // namespace

float mean_grey(const vdna_pixels &pixels)
{
    // The weighted sum is linear, so its mean is that of the channels' means.
    const std::array<uint64_t, 4> sums = sums_of(pixels);
    const double per_pixel = 1.0 / static_cast<double>(uint64_t{pixels.width} * pixels.height);
    const auto mean = [&](int channel) {
        return static_cast<double>(sums[pixels.rgb[channel]]) * per_pixel;
    };
    return static_cast<float>(0.299 * mean(0) + 0.587 * mean(1) + 0.114 * mean(2));
}

} // namespace vdna::picture
