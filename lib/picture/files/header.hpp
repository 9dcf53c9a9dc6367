// What the header of a PNG, WebP or BMP file says, read before anything is allocated for it.
#pragma once

#include "picture/files/bytes.hpp"

namespace vdna::picture
{

struct Header {
    uint32_t width, height; // pixels, as they are stored
    uint32_t orientation;   // as in EXIF, 1..8
};

// Each throws Failure: VDNA_ERR_FORMAT for a header cut short or damaged, VDNA_ERR_UNSUPPORTED for
// a picture of a kind that is not read. A damaged orientation is none.
Header png_header(const Bytes &file);
Header webp_header(const Bytes &file);
Header bmp_header(const Bytes &file);

} // namespace vdna::picture
