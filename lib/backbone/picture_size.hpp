// Width and height of an encoded picture, read from its header before anything is allocated for it.
#pragma once

#include <cstddef>
#include <cstdint>

namespace vdna::backbone
{

enum class Encoding { jpeg, png, webp, bmp, pnm, tiff };

struct EncodedPicture {
    Encoding encoding;
    uint32_t width, height; // pixels
};

// Tell the encoding by its signature. Throws Failure: VDNA_ERR_FORMAT for a header cut short or
// damaged, VDNA_ERR_UNSUPPORTED for any other encoding.
EncodedPicture inspect_picture(const uint8_t *data, size_t size);

} // namespace vdna::backbone
