// The one picture that networks are tested with when they are opened.
#pragma once

#include <vdna/image.h>

namespace vdna::backbone
{

// 384x24 pixels of many colours, so that each step before the network matters: the order of the
// channels, their mean and std, and resizing to fewer columns and more rows. Borrowed for as long
// as the process.
vdna_image test_picture();

} // namespace vdna::backbone
