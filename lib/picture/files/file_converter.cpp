#include "picture/files/file_converter.hpp"

#include <opencv2/imgcodecs.hpp>

#include "failure.hpp"
#include "picture/files/header.hpp"
#include "picture/jpeg.h"
#include "picture/limits.hpp"

namespace vdna::picture
{

namespace
{

// Decode into `bgr`; false if the file is damaged.
bool decode(const uint8_t *data, size_t size, cv::Mat &bgr)
{
    // OpenCV has no read-only matrix, but imdecode() does not write to this one.
    const cv::Mat bytes(1, static_cast<int>(size), CV_8UC1, const_cast<uint8_t *>(data));
    try {
        return !cv::imdecode(bytes, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION, &bgr).empty();
    } catch (const cv::Exception &failure) {
        if (failure.code == cv::Error::StsNoMem)
            throw fail::Failure(VDNA_ERR_NOMEM, vdna_status_text(VDNA_ERR_NOMEM));
        throw fail::Failure(VDNA_ERR_FORMAT, "encoded picture: OpenCV: " + failure.err);
    }
}

} // namespace

vdna_image FileConverter::convert(const uint8_t *data, size_t size)
{
    if (vdna_jpeg_begins(data, size))
        return {data, size, 0, 0, 0, VDNA_PIXEL_MJPG};
    if (size == 0)
        throw fail::Failure(VDNA_ERR_FORMAT, "picture: has no bytes");
    const Sides sides = read_sides(data, size);
    check_sides(sides.width, sides.height, VDNA_IMAGE_PIXELS_MAX);
    if (size > INT32_MAX)
        throw fail::Failure(VDNA_ERR_UNSUPPORTED, "encoded picture: more than 2 GiB");
    if (!decode(data, size, bgr_))
        throw fail::Failure(VDNA_ERR_FORMAT, "encoded picture: is damaged or cut short");
    return {bgr_.data,
            bgr_.step * static_cast<size_t>(bgr_.rows),
            static_cast<uint32_t>(bgr_.cols),
            static_cast<uint32_t>(bgr_.rows),
            static_cast<uint32_t>(bgr_.step),
            VDNA_PIXEL_BGR3};
}

} // namespace vdna::picture
