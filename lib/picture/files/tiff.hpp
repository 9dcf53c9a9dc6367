// The first directory of a TIFF file: what there is, and whether OpenCV reads it as it is meant.
#pragma once

#include <vector>

#include "picture/files/header.hpp"

namespace vdna::picture
{

// Throws Failure: VDNA_ERR_FORMAT for a directory cut short, VDNA_ERR_UNSUPPORTED for a picture
// that has other pixels than grey, palette or colour of 1, 4, 8 or 16 unsigned bits.
Header tiff_header(const Bytes &file);

// The file without what it says about orientation and transparency, of which libtiff and OpenCV
// apply a part that differs with depth and version. For a file that tiff_header() has read.
std::vector<uint8_t> plain_tiff(const Bytes &file);

} // namespace vdna::picture
