// Frames of any source as a camera would send them.
#pragma once

#include <string>

#include "picture/files/file_converter.hpp"

namespace vdna::frames
{

// Convert an encoded picture; return any other unchanged. name: names the frame in complaints. The
// result is borrowed from `image` or, until its next use, from `converter`. Throws BadFrame.
vdna_image camera_image(const vdna_image &image, const std::string &name,
                        picture::FileConverter &converter);

} // namespace vdna::frames
