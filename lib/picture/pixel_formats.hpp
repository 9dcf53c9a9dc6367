// The pixel formats of cameras: one table, for the decoder, its refusals, the tests and the fuzzer.
#pragma once

#include <array>
#include <cstddef>

#include <vdna/image.h>

namespace vdna::picture
{

// How the bytes of a picture lie.
enum class Arrangement {
    jpeg,
    packed,          // pixels that are used where they are
    words,           // grey, two bytes a pixel, the low one first
    yuv422,          // one plane: two pixels share four bytes
    yuv420,          // Y, and two planes of half its stride; two rows share one of chroma
    yuv420_together, // Y, and one plane of its stride; two rows share one of chroma
};

// One row of `width` pixels, which is even, to 3 * width bytes: blue, green, red.
// row: of the first plane; second, third: that row's chroma in the planes after it, not read where
// there are none
using RowToBgr = void (*)(const uint8_t *row, const uint8_t *second, const uint8_t *third,
                          size_t width, uint8_t *out_bgr);

// One row of `width` little-endian words of `bits` significant bits, 10..16, to the nearest 8-bit
// levels. Returns the bits that any word has set; if one is beyond `bits`, the levels mean nothing.
uint32_t words_to_grey(const uint8_t *row, size_t width, uint32_t bits, uint8_t *out_grey);

struct PixelFormat {
    uint32_t fourcc; // VDNA_PIXEL_...
    Arrangement arrangement;
    RowToBgr row_to_bgr = nullptr;      // YUV only
    uint32_t channels = 0;              // bytes of a pixel; packed only
    std::array<uint32_t, 3> rgb = {{}}; // which of them are red, green and blue; packed only
    uint32_t bits = 0;                  // significant ones of a pixel; words only
};

// All but VDNA_PIXEL_ENCODED, which names none.
struct PixelFormats {
    const PixelFormat *first, *last;
    const PixelFormat *begin() const { return first; }
    const PixelFormat *end() const { return last; }
};
extern const PixelFormats pixel_formats;

} // namespace vdna::picture
