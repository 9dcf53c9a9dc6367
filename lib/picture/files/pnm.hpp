// Pictures of the PNM family: PBM, PGM and PPM, as text or bytes.
#pragma once

#include <opencv2/core.hpp>

#include "picture/files/bytes.hpp"

namespace vdna::picture
{

// What the header of a PNM file says.
struct PnmHeader {
    uint32_t width, height; // pixels
    uint32_t channels;      // 1 or 3
    uint32_t white;         // the value of white, 1..65535; of PBM 1
    bool text;              // numbers as text
    bool bits;              // PBM: a bit a pixel, where 0 is white
    size_t pixels_at;       // where the pixels begin
};

// Throws Failure, VDNA_ERR_FORMAT, for a damaged header.
PnmHeader pnm_header(const Bytes &file);

// Decode into `bgr`, of 8 bits, scaled by the value of white. Throws Failure: VDNA_ERR_FORMAT for
// pixels that are missing or beyond white, VDNA_ERR_UNSUPPORTED as check_depth() does.
void decode_pnm(const Bytes &file, const PnmHeader &header, cv::Mat &bgr);

} // namespace vdna::picture
