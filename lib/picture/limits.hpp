// How large a picture may be: checked before anything is allocated or decoded.
#pragma once

#include <cstdint>

namespace vdna::picture
{

// Throws Failure: VDNA_ERR_FORMAT for no pixels at all, VDNA_ERR_UNSUPPORTED for sides beyond
// VDNA_IMAGE_SIDE_MAX or more than `max_pixels` pixels.
void check_sides(uint32_t width, uint32_t height, uint32_t max_pixels);

} // namespace vdna::picture
