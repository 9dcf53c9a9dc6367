// Frames that OpenCV decoded.
#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "frames/source.hpp"

namespace vdna::frames
{

// A picture as a camera would send it; borrows its pixels. name: of the frame. Throws BadFrame.
inline vdna_image image_of(const cv::Mat &picture, const std::string &name)
{
    if (picture.type() != CV_8UC3)
        throw BadFrame(name + ": not 8-bit colour, which OpenCV was expected to give");
    return {picture.data,
            picture.step * static_cast<size_t>(picture.rows),
            static_cast<uint32_t>(picture.cols),
            static_cast<uint32_t>(picture.rows),
            static_cast<uint32_t>(picture.step),
            VDNA_PIXEL_BGR3};
}

} // namespace vdna::frames
