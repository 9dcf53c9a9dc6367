// Decoding of pictures as cameras send them.
#pragma once

#include <memory>

#include <vdna/picture.h>

#include "resample.hpp"

namespace vdna::picture
{

struct PixelFormat;

// Decodes one picture after the other into the same memory.
class Decoder
{
  public:
    // A picture of more than `max_pixels` pixels, 1..VDNA_IMAGE_PIXELS_MAX, is refused.
    explicit Decoder(uint32_t max_pixels = VDNA_IMAGE_PIXELS_MAX);

    // see vdna_decoder_bytes_max()
    static uint64_t bytes_max(uint32_t max_pixels);

    // No reduced picture is that large.
    static constexpr Size whole = {UINT32_MAX, UINT32_MAX};

    // see vdna_decoder_decode() and vdna_decoder_decode_reduced(). Throws Failure.
    vdna_pixels decode(const vdna_image &image, Size least = whole);

  private:
    vdna_pixels packed(const vdna_image &image, const PixelFormat &format) const;
    vdna_pixels encoded(const vdna_image &image, Size least);
    vdna_pixels yuv422(const vdna_image &image, const PixelFormat &format);
    vdna_pixels yuv420(const vdna_image &image, const PixelFormat &format);
    vdna_pixels words(const vdna_image &image, const PixelFormat &format);
    vdna_pixels own_bgr(uint32_t width, uint32_t height) const;

    uint32_t max_pixels_;
    std::unique_ptr<uint8_t[]> bgr_; // 3 * max_pixels_ bytes
    std::unique_ptr<uint8_t[]> row_; // the longest row of a picture that is to be turned
};

} // namespace vdna::picture
