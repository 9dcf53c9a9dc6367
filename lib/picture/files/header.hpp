// Width and height of a picture file, read from its header before anything is allocated for it.
#pragma once

#include <cstddef>
#include <cstdint>

namespace vdna::picture
{

struct Sides {
    uint32_t width, height; // pixels
};

// Of a PNG, WebP, BMP, PNM or TIFF file, told by its signature. Throws Failure: VDNA_ERR_FORMAT for
// a header cut short or damaged, VDNA_ERR_UNSUPPORTED for any other file.
Sides read_sides(const uint8_t *data, size_t size);

} // namespace vdna::picture
