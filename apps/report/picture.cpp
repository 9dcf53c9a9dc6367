#include "report/picture.hpp"

#include <algorithm>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <vdna/cpp/decoder.hpp>

#include "frames/camera_image.hpp"
#include "frames/picture_list.hpp"
#include "frames/source.hpp"
#include "record/thumbnails.hpp"

namespace vdna::report
{

namespace
{

constexpr int photo_width = 160; // pixels
constexpr int photo_quality = 70;

vdna_image encoded_image(const void *bytes, size_t size)
{
    return {static_cast<const uint8_t *>(bytes), size, 0, 0, 0, VDNA_PIXEL_ENCODED};
}

// Empty if it is not a picture, or has more than pixels_max.
cv::Mat decoded(const vdna_image &image, uint32_t pixels_max)
{
    vdna_decoder *opened = nullptr;
    if (vdna_decoder_open(pixels_max, nullptr, &opened) != VDNA_OK)
        return {};
    const Decoder decoder(opened);
    vdna_pixels pixels;
    if (vdna_decoder_decode(decoder.get(), &image, nullptr, &pixels) != VDNA_OK)
        return {};
    // Pixels of either kind of file are BGR.
    return cv::Mat(static_cast<int>(pixels.height), static_cast<int>(pixels.width), CV_8UC3,
                   const_cast<uint8_t *>(pixels.data), pixels.stride)
        .clone();
}

// The picture as the network sees it; empty if the file is unreadable or not a picture.
cv::Mat read_pixels(const std::filesystem::path &file)
{
    try {
        const std::vector<uint8_t> bytes = frames::read_picture(file);
        picture::FileConverter converter;
        return decoded(frames::camera_image(encoded_image(bytes.data(), bytes.size()),
                                            file.string(), converter),
                       VDNA_IMAGE_PIXELS_MAX);
    } catch (const frames::BadFrame &) {
        return {};
    }
}

} // namespace

Encoded shades_png(const Shades &shades, int side)
{
    cv::Mat grey(static_cast<int>(shades.rows), static_cast<int>(shades.columns), CV_8UC1);
    const double scale = 255 / (shades.white - shades.black);
    for (int r = 0; r < grey.rows; r++)
        for (int c = 0; c < grey.cols; c++) {
            const double value =
                shades.values[static_cast<size_t>(r) * shades.columns + static_cast<size_t>(c)];
            grey.at<uint8_t>(r, c) = cv::saturate_cast<uint8_t>((value - shades.black) * scale);
        }
    cv::resize(grey, grey, {std::min(grey.cols, side), std::min(grey.rows, side)}, 0, 0,
               cv::INTER_AREA);
    Encoded picture{{}, grey.cols, grey.rows};
    cv::imencode(".png", grey, picture.bytes, {cv::IMWRITE_PNG_COMPRESSION, 9});
    return picture;
}

Encoded photo_jpeg(const std::filesystem::path &file)
{
    cv::Mat pixels = read_pixels(file);
    if (pixels.empty())
        return {};
    const int width = std::min(pixels.cols, photo_width);
    const int height = std::max(pixels.rows * width / pixels.cols, 1);
    cv::resize(pixels, pixels, {width, height}, 0, 0, cv::INTER_AREA);
    Encoded picture{{}, width, height};
    cv::imencode(".jpg", pixels, picture.bytes, {cv::IMWRITE_JPEG_QUALITY, photo_quality});
    return picture;
}

Encoded thumbnail_jpeg(std::string_view jpeg)
{
    const cv::Mat pixels =
        decoded(encoded_image(jpeg.data(), jpeg.size()), record::Thumbnails::pixels_max);
    if (pixels.empty())
        return {};
    return {{jpeg.begin(), jpeg.end()}, pixels.cols, pixels.rows};
}

} // namespace vdna::report
