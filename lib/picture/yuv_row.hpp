// One row of YUV to BGR: BT.601 with 16..235, two pixels to a pair of U and V. Templates, so that
// each format is compiled for itself.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "vectorised.h"

namespace vdna::picture::yuv
{

// The factors of BT.601, times 2^20, as OpenCV rounds them: its conversion is exact to the bit.
inline constexpr int bits = 20;
inline constexpr int32_t y_to_all = 1220542, u_to_blue = 2116026, u_to_green = -409993,
                         v_to_green = -852492, v_to_red = 1673527;
inline constexpr int32_t black = 16, no_chroma = 128;

inline constexpr size_t pairs_at_once = 64;

using Sixteen = uint8_t __attribute__((vector_size(16)));

// A pixel is written as one number, whose lowest byte must come first in memory.
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "blue must be the lowest of four bytes");

inline uint32_t level(int32_t sum)
{
    return static_cast<uint32_t>(std::clamp(sum >> bits, 0, 255));
}

// Luma is at y[y_at], y[y_at + y_step], ..., chroma at u[u_at], v[v_at], u[u_at + c_step], ...
// These are constants, and interleaved planes share one pointer, so that the compiler can
// deinterleave whole vectors.
struct Layout {
    size_t y_at, y_step, u_at, v_at, c_step;
};

// Four bytes a pixel, the last of them 0.
template <const Layout &At>
[[gnu::always_inline]] inline void convert_pairs(const uint8_t *y, const uint8_t *u,
                                                 const uint8_t *v, size_t pairs,
                                                 uint32_t *__restrict out)
{
    constexpr int32_t half = 1 << (bits - 1);
    for (size_t i = 0; i < pairs; i++) {
        const int32_t from_u = u[At.c_step * i + At.u_at] - no_chroma;
        const int32_t from_v = v[At.c_step * i + At.v_at] - no_chroma;
        const int32_t blue = half + u_to_blue * from_u;
        const int32_t green = half + u_to_green * from_u + v_to_green * from_v;
        const int32_t red = half + v_to_red * from_v;
        for (size_t k = 0; k < 2; k++) {
            const int32_t above = std::max(y[At.y_step * (2 * i + k) + At.y_at] - black, 0);
            const int32_t luma = y_to_all * above;
            out[2 * i + k] =
                level(luma + blue) | level(luma + green) << 8 | level(luma + red) << 16;
        }
    }
}

// Drop every fourth byte. Sixteen bytes are written for twelve; the next four pixels overwrite the
// rest. Inlined, it costs I420 a twentieth.
VDNA_VECTORISED_FROM_V2 static void pack(const uint32_t *pixels, size_t count, uint8_t *out)
{
    size_t i = 0;
    for (; i + 8 <= count; i += 4) {
        Sixteen four;
        std::memcpy(&four, pixels + i, sizeof four);
        four = __builtin_shufflevector(four, four, 0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, 3, 7, 11,
                                       15);
        std::memcpy(out + 3 * i, &four, sizeof four);
    }
    for (; i < count; i++)
        std::memcpy(out + 3 * i, pixels + i, 3);
}

// One row of `width` pixels, which is even, to 3 * width bytes: blue, green, red.
template <const Layout &At>
[[gnu::always_inline]] inline void convert_row(const uint8_t *y, const uint8_t *u, const uint8_t *v,
                                               size_t width, uint8_t *out)
{
    uint32_t pixels[2 * pairs_at_once];
    for (size_t left = width / 2; left > 0;) {
        const size_t pairs = std::min(left, pairs_at_once);
        convert_pairs<At>(y, u, v, pairs, pixels);
        pack(pixels, 2 * pairs, out);
        y += 2 * At.y_step * pairs;
        u += At.c_step * pairs;
        v += At.c_step * pairs;
        out += 6 * pairs;
        left -= pairs;
    }
}

} // namespace vdna::picture::yuv
