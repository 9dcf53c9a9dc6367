#include "small_jpeg.hpp"

#include <algorithm>
#include <cstdlib>
#include <new>

#include "jpeg_writer.h"

namespace vdna::picture
{

namespace
{

std::string encode(const vdna_pixels &pixels, int quality, bool small)
{
    uint8_t *data = nullptr;
    size_t size = 0;
    if (!vdna_jpeg_write(&pixels, quality, small ? 1 : 0, &data, &size))
        throw std::bad_alloc();
    const std::unique_ptr<uint8_t, decltype(&std::free)> owner(data, std::free);
    return {reinterpret_cast<const char *>(data), size};
}

} // namespace

vdna_pixels Shrinker::shrink(const vdna_pixels &pixels)
{
    const uint32_t side = std::max(pixels.width, pixels.height);
    if (side <= side_max_)
        return pixels;
    const auto shorter = [&](uint32_t length) {
        return std::max(1u, static_cast<uint32_t>(uint64_t{length} * side_max_ / side));
    };
    const Size size{shorter(pixels.width), shorter(pixels.height)};
    if (size != size_)
        resampler_ = std::make_unique<Resampler>(Interpolation::area, size);
    size_ = size;

    vdna_pixels result = pixels;
    result.width = size.width;
    result.height = size.height;
    result.stride = size_t{size.width} * pixels.channels;
    small_.resize(result.stride * size.height);
    uint8_t *const data = reinterpret_cast<uint8_t *>(small_.data());
    result.data = data;
    resampler_->begin(pixels);
    for (uint32_t y = 0; y < size.height; y++)
        resampler_->next_row(data + y * result.stride);
    return result;
}

std::string jpeg_of(const vdna_pixels &pixels, int quality)
{
    return encode(pixels, quality, false);
}

std::string jpeg_within(const vdna_pixels &pixels, size_t bytes_max)
{
    for (const int quality : {80, 65, 50, 35, 20, 10, 1}) {
        std::string jpeg = encode(pixels, quality, true);
        if (jpeg.size() <= bytes_max)
            return jpeg;
    }
    return "";
}

} // namespace vdna::picture
