// Pixels that OpenCV decoded, as a camera would send them.
#pragma once

#include <opencv2/core.hpp>

#include <vdna/image.h>

namespace vdna::picture
{

// bgr: 8-bit colour; its pixels are borrowed.
inline vdna_image image_of(const cv::Mat &bgr)
{
    return {bgr.data,
            bgr.step * static_cast<size_t>(bgr.rows),
            static_cast<uint32_t>(bgr.cols),
            static_cast<uint32_t>(bgr.rows),
            static_cast<uint32_t>(bgr.step),
            VDNA_PIXEL_BGR3};
}

} // namespace vdna::picture
