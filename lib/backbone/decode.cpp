#include "decode.hpp"

#include <cctype>
#include <string>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "failure.hpp"
#include "jpeg.h"
#include "picture_size.hpp"

namespace vdna::backbone
{

namespace
{

constexpr std::array<int, 3> bgr_order{2, 1, 0};

// Formats whose pixels are used where they are.
struct PackedFormat {
    uint32_t pixelformat;
    int channels;
    std::array<int, 3> rgb;
};
constexpr PackedFormat packed_formats[] = {
    {VDNA_PIXEL_GREY, 1, {0, 0, 0}}, {VDNA_PIXEL_RGB3, 3, {0, 1, 2}},
    {VDNA_PIXEL_BGR3, 3, bgr_order}, {VDNA_PIXEL_RGB4, 4, {0, 1, 2}},
    {VDNA_PIXEL_BGR4, 4, bgr_order},
};

std::string fourcc_text(uint32_t pixelformat)
{
    std::string text;
    for (int shift = 0; shift < 32; shift += 8) {
        const auto letter = static_cast<unsigned char>(pixelformat >> shift);
        text += std::isprint(letter) ? static_cast<char>(letter) : '?';
    }
    return text;
}

std::string size_text(uint32_t width, uint32_t height)
{
    return std::to_string(width) + "x" + std::to_string(height);
}

[[noreturn]] void refuse_layout(const vdna_image &image, const std::string &expected)
{
    throw Failure(VDNA_ERR_FORMAT, "picture: " + fourcc_text(image.pixelformat) + " " +
                                       size_text(image.width, image.height) + ", row stride " +
                                       std::to_string(image.row_stride) + ", " +
                                       std::to_string(image.size) + " bytes: expected " + expected);
}

// Bytes from row to row, checked against what a row needs.
size_t stride_of(const vdna_image &image, size_t row_bytes)
{
    if (image.row_stride == 0)
        return row_bytes;
    if (image.row_stride < row_bytes)
        refuse_layout(image, "at least " + std::to_string(row_bytes) + " bytes a row");
    return image.row_stride;
}

void need_bytes(const vdna_image &image, size_t bytes)
{
    if (image.size < bytes)
        refuse_layout(image, "at least " + std::to_string(bytes) + " bytes");
}

// The caller's bytes as a matrix. OpenCV has no read-only one; it is only read from.
cv::Mat view(const vdna_image &image, uint32_t rows, size_t columns, int type, size_t stride)
{
    return cv::Mat(static_cast<int>(rows), static_cast<int>(columns), type,
                   const_cast<uint8_t *>(image.data), stride);
}

} // namespace

uint64_t Decoder::bytes_for(uint32_t max_pixels)
{
    // libjpeg keeps all coefficients of a progressive picture, two bytes each for up to three
    // components, whose sides it rounds up to whole blocks of at most 32 pixels; else a few rows.
    constexpr uint64_t block = 32, components = 3, row_bytes = 4u << 20;
    const uint64_t edge = VDNA_IMAGE_SIDE_MAX + max_pixels / VDNA_IMAGE_SIDE_MAX + block;
    const uint64_t padded = max_pixels + block * edge;
    return components * max_pixels + 2 * components * padded + row_bytes;
}

void Decoder::check_sides(uint32_t width, uint32_t height) const
{
    if (width == 0 || height == 0)
        throw Failure(VDNA_ERR_FORMAT, "picture: has no pixels: " + size_text(width, height));
    if (width > VDNA_IMAGE_SIDE_MAX || height > VDNA_IMAGE_SIDE_MAX || width * height > max_pixels_)
        throw Failure(VDNA_ERR_UNSUPPORTED, "picture: " + size_text(width, height) +
                                                " pixels are too many; the limit is " +
                                                std::to_string(VDNA_IMAGE_SIDE_MAX) +
                                                " a side and " + std::to_string(max_pixels_) +
                                                " in all");
}

// A view of an image whose pixels have `channels` bytes each.
cv::Mat Decoder::packed_view(const vdna_image &image, int channels) const
{
    check_sides(image.width, image.height);
    const size_t row_bytes = size_t{image.width} * static_cast<size_t>(channels);
    const size_t stride = stride_of(image, row_bytes);
    need_bytes(image, stride * (image.height - 1) + row_bytes);
    return view(image, image.height, image.width, CV_8UC(channels), stride);
}

Picture Decoder::decode(const vdna_image &image)
{
    if (!image.data || image.size == 0)
        throw Failure(VDNA_ERR_FORMAT, "picture: has no bytes");
    for (const PackedFormat &format : packed_formats)
        if (format.pixelformat == image.pixelformat)
            return {packed_view(image, format.channels), format.rgb};

    switch (image.pixelformat) {
    case VDNA_PIXEL_ENCODED:
    case VDNA_PIXEL_MJPG:
        return encoded(image);
    case VDNA_PIXEL_YUYV:
        return yuv422(image, cv::COLOR_YUV2BGR_YUYV);
    case VDNA_PIXEL_UYVY:
        return yuv422(image, cv::COLOR_YUV2BGR_UYVY);
    case VDNA_PIXEL_I420:
    case VDNA_PIXEL_YU12:
        return yuv420(image, cv::COLOR_YUV2BGR_I420);
    case VDNA_PIXEL_NV12:
        return yuv420(image, cv::COLOR_YUV2BGR_NV12);
    default:
        throw Failure(VDNA_ERR_UNSUPPORTED,
                      "picture: unknown pixel format '" + fourcc_text(image.pixelformat) +
                          "'; expected MJPG, GREY, RGB3, BGR3, RGB4, BGR4, YUYV, UYVY, I420, YU12 "
                          "or NV12");
    }
}

Picture Decoder::encoded(const vdna_image &image)
{
    const EncodedPicture found = inspect_picture(image.data, image.size);
    if (image.pixelformat == VDNA_PIXEL_MJPG && found.encoding != Encoding::jpeg)
        throw Failure(VDNA_ERR_FORMAT, "picture: MJPG must hold a JPEG picture");
    check_sides(found.width, found.height);

    if (found.encoding == Encoding::jpeg) {
        bgr_.create(static_cast<int>(found.height), static_cast<int>(found.width), CV_8UC3);
        char reason[VDNA_JPEG_REASON_MAX];
        if (!vdna_jpeg_decode(image.data, image.size, bgr_.data, bgr_.step, reason))
            throw Failure(VDNA_ERR_FORMAT, std::string("JPEG picture: ") + reason);
        return {bgr_, bgr_order};
    }
    if (image.size > INT32_MAX)
        throw Failure(VDNA_ERR_UNSUPPORTED, "encoded picture: more than 2 GiB");
    const cv::Mat bytes = view(image, 1, image.size, CV_8UC1, image.size);
    if (cv::imdecode(bytes, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION, &bgr_).empty())
        throw Failure(VDNA_ERR_FORMAT, "encoded picture: is damaged or cut short");
    return {bgr_, bgr_order};
}

Picture Decoder::yuv422(const vdna_image &image, int conversion)
{
    if (image.width % 2 != 0)
        refuse_layout(image, "an even width");
    cv::cvtColor(packed_view(image, 2), bgr_, conversion);
    return {bgr_, bgr_order};
}

Picture Decoder::yuv420(const vdna_image &image, int conversion)
{
    check_sides(image.width, image.height);
    const size_t stride = stride_of(image, image.width);
    if (image.width % 2 != 0 || image.height % 2 != 0 || stride % 2 != 0)
        refuse_layout(image, "an even width, height and row stride");
    need_bytes(image, stride * (image.height + image.height / 2));

    // OpenCV takes the chroma rows of I420 to be as wide as the picture, so padding is converted
    // along with it, as a wider picture, and left out of the result.
    if (stride > VDNA_IMAGE_SIDE_MAX)
        refuse_layout(image, "a row stride of at most " + std::to_string(VDNA_IMAGE_SIDE_MAX));
    check_sides(static_cast<uint32_t>(stride), image.height);
    const cv::Mat planes = view(image, image.height + image.height / 2, stride, CV_8UC1, stride);
    cv::cvtColor(planes, bgr_, conversion);
    return {bgr_.colRange(0, static_cast<int>(image.width)), bgr_order};
}

float mean_grey(const Picture &picture)
{
    // The weighted sum is linear, so the mean of it is that of the channels' means.
    const cv::Scalar mean = cv::mean(picture.pixels);
    return static_cast<float>(0.299 * mean[picture.rgb[0]] + 0.587 * mean[picture.rgb[1]] +
                              0.114 * mean[picture.rgb[2]]);
}

} // namespace vdna::backbone
