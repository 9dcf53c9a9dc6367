// YUV to BGR: BT.601 with luma 16..235; two pixels share one U and one V.
#pragma once

#include <cstddef>
#include <cstdint>

namespace vdna::picture
{

// Each converts one row of `width` pixels, which is even, to 3 * width bytes: blue, green, red.
void yuyv_to_bgr(const uint8_t *row, size_t width, uint8_t *out_bgr);
void uyvy_to_bgr(const uint8_t *row, size_t width, uint8_t *out_bgr);
// u, v: width / 2 bytes each
void i420_to_bgr(const uint8_t *y, const uint8_t *u, const uint8_t *v, size_t width,
                 uint8_t *out_bgr);
// uv: width bytes, U first
void nv12_to_bgr(const uint8_t *y, const uint8_t *uv, size_t width, uint8_t *out_bgr);

} // namespace vdna::picture
