// Frames that OpenCV decoded.
#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "frames/source.hpp"
#include "picture/files/matrix_image.hpp"

namespace vdna::frames
{

// A picture as a camera would send it; borrows its pixels. name: of the frame. Throws BadFrame.
inline vdna_image image_of(const cv::Mat &pixels, const std::string &name)
{
    if (pixels.type() != CV_8UC3)
        throw BadFrame(name + ": not 8-bit colour, which OpenCV was expected to give");
    return picture::image_of(pixels);
}

} // namespace vdna::frames
