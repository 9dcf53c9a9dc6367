#include "pixel_formats.hpp"

#include <iterator>

#include "vectorised.h"
#include "yuv_row.hpp"

namespace vdna::picture
{

namespace
{

constexpr yuv::Layout yuyv{0, 2, 1, 3, 4}, uyvy{1, 2, 0, 2, 4}, planes{0, 1, 0, 0, 1},
    u_then_v{0, 1, 0, 1, 2};

VDNA_VECTORISED_FROM_V2 void yuyv_to_bgr(const uint8_t *row, const uint8_t *, const uint8_t *,
                                         size_t width, uint8_t *out_bgr)
{
    yuv::convert_row<yuyv>(row, row, row, width, out_bgr);
}

VDNA_VECTORISED_FROM_V2 void uyvy_to_bgr(const uint8_t *row, const uint8_t *, const uint8_t *,
                                         size_t width, uint8_t *out_bgr)
{
    yuv::convert_row<uyvy>(row, row, row, width, out_bgr);
}

VDNA_VECTORISED_FROM_V2 void i420_to_bgr(const uint8_t *y, const uint8_t *u, const uint8_t *v,
                                         size_t width, uint8_t *out_bgr)
{
    yuv::convert_row<planes>(y, u, v, width, out_bgr);
}

VDNA_VECTORISED_FROM_V2 void nv12_to_bgr(const uint8_t *y, const uint8_t *uv, const uint8_t *,
                                         size_t width, uint8_t *out_bgr)
{
    yuv::convert_row<u_then_v>(y, uv, uv, width, out_bgr);
}

constexpr PixelFormat packed(uint32_t fourcc, uint32_t channels, std::array<uint32_t, 3> rgb)
{
    return {fourcc, Arrangement::packed, nullptr, channels, rgb};
}

constexpr PixelFormat words(uint32_t fourcc, uint32_t bits)
{
    return {fourcc, Arrangement::words, nullptr, 0, {}, bits};
}

const PixelFormat table[] = {
    {VDNA_PIXEL_MJPG, Arrangement::jpeg},
    packed(VDNA_PIXEL_GREY, 1, {0, 0, 0}),
    packed(VDNA_PIXEL_RGB3, 3, {0, 1, 2}),
    packed(VDNA_PIXEL_BGR3, 3, {2, 1, 0}),
    packed(VDNA_PIXEL_RGB4, 4, {0, 1, 2}),
    packed(VDNA_PIXEL_BGR4, 4, {2, 1, 0}),
    words(VDNA_PIXEL_Y10, 10),
    words(VDNA_PIXEL_Y12, 12),
    words(VDNA_PIXEL_Y14, 14),
    words(VDNA_PIXEL_Y16, 16),
    words(VDNA_PIXEL_LG16, 16),
    {VDNA_PIXEL_YUYV, Arrangement::yuv422, yuyv_to_bgr},
    {VDNA_PIXEL_UYVY, Arrangement::yuv422, uyvy_to_bgr},
    {VDNA_PIXEL_I420, Arrangement::yuv420, i420_to_bgr},
    {VDNA_PIXEL_YU12, Arrangement::yuv420, i420_to_bgr},
    {VDNA_PIXEL_NV12, Arrangement::yuv420_together, nv12_to_bgr},
};

} // namespace

VDNA_VECTORISED_FROM_V2 uint32_t words_to_grey(const uint8_t *row, size_t width, uint32_t bits,
                                               uint8_t *out_grey)
{
    const uint32_t white = (1u << bits) - 1;
    uint32_t used = 0;
    for (size_t x = 0; x < width; x++) {
        const uint32_t value = row[2 * x] | static_cast<uint32_t>(row[2 * x + 1]) << 8;
        used |= value;
        // n / white, exactly, for n < 2^(2 bits) - 1: vectors cannot divide.
        const uint32_t n = value * 255 + white / 2;
        out_grey[x] = static_cast<uint8_t>((n + (n >> bits) + 1) >> bits);
    }
    return used;
}

const PixelFormats pixel_formats = {std::begin(table), std::end(table)};

} // namespace vdna::picture
