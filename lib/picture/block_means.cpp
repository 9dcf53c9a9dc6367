#include "block_means.hpp"

#include "rounding.hpp"
#include "vectorised.h"

namespace vdna::picture
{

namespace
{

VDNA_VECTORISED void set_row(const uint8_t *row, size_t count, uint32_t *sums)
{
    for (size_t i = 0; i < count; i++)
        sums[i] = row[i];
}

VDNA_VECTORISED void add_row(const uint8_t *row, size_t count, uint32_t *sums)
{
    for (size_t i = 0; i < count; i++)
        sums[i] += row[i];
}

// Means of 2x2 pixels whose rows are summed already. Round halves up.
template <size_t Channels>
VDNA_VECTORISED void quarters(const uint32_t *sums, uint32_t width, uint8_t *__restrict out)
{
    for (size_t x = 0; x < width; x++)
        for (size_t c = 0; c < Channels; c++)
            out[Channels * x + c] = static_cast<uint8_t>(
                (sums[2 * Channels * x + c] + sums[2 * Channels * x + Channels + c] + 2) >> 2);
}

// Means of any other block. Round halves to even.
void means(const uint32_t *sums, Size block, size_t channels, uint32_t width, uint8_t *out)
{
    const float part = 1.0f / static_cast<float>(block.width * block.height);
    for (uint32_t x = 0; x < width; x++, sums += block.width * channels)
        for (size_t c = 0; c < channels; c++) {
            uint64_t sum = 0;
            for (uint32_t i = 0; i < block.width; i++)
                sum += sums[i * channels + c];
            *out++ = level_of(static_cast<float>(sum) * part);
        }
}

} // namespace

BlockMeans::BlockMeans(Size to)
    // Left uninitialised, so that it is not resident before a picture needs it.
    : to_(to), sums_(new uint32_t[VDNA_IMAGE_SIDE_MAX * channels_max])
{
}

void BlockMeans::begin(const vdna_pixels &picture)
{
    picture_ = picture;
    next_ = 0;
}

void BlockMeans::next_row(uint8_t *out)
{
    const Size block = {picture_.width / to_.width, picture_.height / to_.height};
    const size_t channels = picture_.channels, count = picture_.width * channels;
    const uint8_t *row = picture_.data + size_t{next_++} * block.height * picture_.stride;
    uint32_t *const sums = sums_.get();
    set_row(row, count, sums);
    for (uint32_t i = 1; i < block.height; i++)
        add_row(row + i * picture_.stride, count, sums);

    if (block != Size{2, 2})
        means(sums, block, channels, to_.width, out);
    else if (channels == 1)
        quarters<1>(sums, to_.width, out);
    else if (channels == 3)
        quarters<3>(sums, to_.width, out);
    else
        quarters<4>(sums, to_.width, out);
}

} // namespace vdna::picture
