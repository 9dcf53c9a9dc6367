#include "serve/camera_jpeg.hpp"

#include <new>

#include <vdna/cpp/error.hpp>

#include "picture/jpeg.h"

namespace vdna::serve
{

namespace
{

constexpr int quality = 80;

} // namespace

std::string CameraJpeg::of(const vdna_image &image)
{
    const bool encoded =
        image.pixelformat == VDNA_PIXEL_MJPG || image.pixelformat == VDNA_PIXEL_ENCODED;
    if (encoded && image.size <= as_received_max && vdna_jpeg_begins(image.data, image.size))
        return {reinterpret_cast<const char *>(image.data), image.size};

    vdna_pixels pixels;
    vdna_error error{};
    require(
        vdna_decoder_decode_reduced(decoder_.get(), &image, side_max, side_max, &error, &pixels),
        error);
    try {
        return picture::jpeg_of(shrinker_.shrink(pixels), quality);
    } catch (const std::bad_alloc &) {
        throw Error("the picture cannot be encoded as JPEG: no memory left");
    }
}

} // namespace vdna::serve
