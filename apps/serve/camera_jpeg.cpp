#include "serve/camera_jpeg.hpp"

#include <algorithm>
#include <cstdlib>

#include <vdna/cpp/error.hpp>

#include "jpeg_writer.h"
#include "picture/jpeg.h"

namespace vdna::serve
{

CameraJpeg::CameraJpeg()
{
    vdna_decoder *decoder = nullptr;
    vdna_error error{};
    require(vdna_decoder_open(pixels_max, &error, &decoder), error);
    decoder_.reset(decoder);
}

vdna_pixels CameraJpeg::small_enough(const vdna_pixels &pixels)
{
    const uint32_t side = std::max(pixels.width, pixels.height);
    if (side <= side_max)
        return pixels;
    const auto shorter = [&](uint32_t length) {
        return std::max(1u, static_cast<uint32_t>(uint64_t{length} * side_max / side));
    };
    const picture::Size size{shorter(pixels.width), shorter(pixels.height)};
    if (size != size_)
        resampler_ = std::make_unique<picture::Resampler>(picture::Interpolation::area, size);
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

std::string CameraJpeg::of(const vdna_image &image)
{
    const bool encoded =
        image.pixelformat == VDNA_PIXEL_MJPG || image.pixelformat == VDNA_PIXEL_ENCODED;
    if (encoded && image.size <= as_received_max && vdna_jpeg_begins(image.data, image.size))
        return {reinterpret_cast<const char *>(image.data), image.size};

    vdna_pixels pixels;
    vdna_error error{};
    require(vdna_decoder_decode(decoder_.get(), &image, &error, &pixels), error);
    pixels = small_enough(pixels);
    uint8_t *data = nullptr;
    size_t size = 0;
    if (!vdna_jpeg_write(&pixels, &data, &size))
        throw Error("the picture cannot be encoded as JPEG: no memory left");
    const std::unique_ptr<uint8_t, decltype(&std::free)> owner(data, std::free);
    return {reinterpret_cast<const char *>(data), size};
}

} // namespace vdna::serve
