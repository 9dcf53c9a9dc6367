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

const PixelFormat table[] = {
    {VDNA_PIXEL_MJPG, Arrangement::jpeg},
    packed(VDNA_PIXEL_GREY, 1, {0, 0, 0}),
    packed(VDNA_PIXEL_RGB3, 3, {0, 1, 2}),
    packed(VDNA_PIXEL_BGR3, 3, {2, 1, 0}),
    packed(VDNA_PIXEL_RGB4, 4, {0, 1, 2}),
    packed(VDNA_PIXEL_BGR4, 4, {2, 1, 0}),
    {VDNA_PIXEL_YUYV, Arrangement::yuv422, yuyv_to_bgr},
    {VDNA_PIXEL_UYVY, Arrangement::yuv422, uyvy_to_bgr},
    {VDNA_PIXEL_I420, Arrangement::yuv420, i420_to_bgr},
    {VDNA_PIXEL_YU12, Arrangement::yuv420, i420_to_bgr},
    {VDNA_PIXEL_NV12, Arrangement::yuv420_together, nv12_to_bgr},
};

} // namespace

const PixelFormats pixel_formats = {std::begin(table), std::end(table)};

} // namespace vdna::picture
