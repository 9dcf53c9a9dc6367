// Picture files to pictures as a camera sends them.
#pragma once

#include <opencv2/core.hpp>

#include <vdna/image.h>

namespace vdna::picture
{

// Converts one file after the other.
class FileConverter
{
  public:
    // The bytes of a JPEG, PNG, WebP, BMP, PNM or TIFF file as a picture in a camera's format: a
    // JPEG file as it is, as MJPG; any other decoded, as BGR3. So a folder of pictures, a log of
    // them as camera messages and the robot's own camera go through one decoder, which turns JPEG
    // pictures; the others are turned here. docs/reference/pictures.md has the contract.
    //  - width and height are read from the header before anything is allocated for them, and are
    //    limited by VDNA_IMAGE_SIDE_MAX and VDNA_IMAGE_PIXELS_MAX.
    // The result is borrowed from `data` or, until the next call, from the converter.
    // Throws Failure: VDNA_ERR_FORMAT for a damaged file, VDNA_ERR_UNSUPPORTED for one of another
    // kind or one too large, VDNA_ERR_NOMEM. Whether a JPEG file is damaged shows only when it is
    // decoded.
    vdna_image convert(const uint8_t *data, size_t size);

  private:
    cv::Mat bgr_;
};

} // namespace vdna::picture
