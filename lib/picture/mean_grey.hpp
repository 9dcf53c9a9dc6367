// Mean grey level of a whole picture.
#pragma once

#include <vdna/picture.h>

namespace vdna::picture
{

// 0..255 (BT.601).
float mean_grey(const vdna_pixels &pixels);

} // namespace vdna::picture
