// Pictures as cameras and files have them, to pixels in memory.
#pragma once

#include <array>

#include <opencv2/core.hpp>

#include <vdna/image.h>

namespace vdna::backbone
{

// 8-bit pixels of 1, 3 or 4 channels.
struct Picture {
    static constexpr size_t most_channels = 4;
    cv::Mat pixels;
    std::array<int, 3> rgb; // which channel is red, green, blue; all 0 for a grey picture
};

// Decodes one picture after the other into the same memory.
class Decoder
{
  public:
    // A picture of more than `max_pixels` pixels, 1..VDNA_IMAGE_PIXELS_MAX, is refused.
    explicit Decoder(uint32_t max_pixels = VDNA_IMAGE_PIXELS_MAX) : max_pixels_(max_pixels) {}

    // Most bytes that a picture takes which is not larger than `max_pixels`; not for
    // VDNA_PIXEL_ENCODED, whose formats are OpenCV's to decode.
    static uint64_t bytes_for(uint32_t max_pixels);

    // The result is borrowed from `image` (formats that need no conversion) or from the decoder
    // (until the next call). Every field of `image` is checked before a byte is used. Rules that
    // its header leaves open:
    //  - rows may be padded; the last row of a packed format may end at its last pixel;
    //  - 4:2:0 formats have whole rows, even sides, and an even row_stride of at most
    //    VDNA_IMAGE_SIDE_MAX; chroma rows of I420 have half of it;
    //  - YUV is BT.601 with 16..235, as cameras give it; MJPG and JPEG are full range;
    //  - an orientation in EXIF is not applied: frames of a camera have none;
    //  - transparency is dropped, 16-bit channels keep their upper 8 bits.
    // Throws Failure (VDNA_ERR_FORMAT, VDNA_ERR_UNSUPPORTED), cv::Exception, std::bad_alloc.
    Picture decode(const vdna_image &image);

  private:
    void check_sides(uint32_t width, uint32_t height) const;
    cv::Mat packed_view(const vdna_image &image, int channels) const;
    Picture encoded(const vdna_image &image);
    Picture yuv422(const vdna_image &image, int conversion);
    Picture yuv420(const vdna_image &image, int conversion);

    uint32_t max_pixels_;
    cv::Mat bgr_;
};

// Mean grey level of a whole picture, 0..255 (BT.601).
float mean_grey(const Picture &picture);

} // namespace vdna::backbone
