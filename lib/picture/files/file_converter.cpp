#include "picture/files/file_converter.hpp"

#include <opencv2/imgcodecs.hpp>

#include "picture/exif.h"
#include "picture/files/header.hpp"
#include "picture/files/kind.hpp"
#include "picture/files/matrix_image.hpp"
#include "picture/files/pnm.hpp"
#include "picture/files/tiff.hpp"
#include "picture/jpeg.h"
#include "picture/levels.hpp"
#include "picture/limits.hpp"

namespace vdna::picture
{

namespace
{

Header header_of(Kind kind, const Bytes &file)
{
    switch (kind) {
    case Kind::png:
        return png_header(file);
    case Kind::webp:
        return webp_header(file);
    case Kind::bmp:
        return bmp_header(file);
    case Kind::tiff:
        return tiff_header(file);
    case Kind::pnm:
        break;
    }
    const PnmHeader pnm = pnm_header(file);
    return {pnm.width, pnm.height, VDNA_UPRIGHT};
}

// As the file has it: 8 or 16 bits, not turned, without transparency, three channels.
cv::Mat decode_as_stored(const uint8_t *data, size_t size)
{
    constexpr int flags = cv::IMREAD_COLOR | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION;
    // OpenCV has no read-only matrix, but imdecode() does not write to this one.
    const cv::Mat bytes(1, static_cast<int>(size), CV_8UC1, const_cast<uint8_t *>(data));
    cv::Mat stored;
    try {
        stored = cv::imdecode(bytes, flags);
    } catch (const cv::Exception &failure) {
        if (failure.code == cv::Error::StsNoMem)
            throw fail::Failure(VDNA_ERR_NOMEM, vdna_status_text(VDNA_ERR_NOMEM));
        damaged("OpenCV: " + failure.err);
    }
    if (stored.empty())
        damaged("is damaged or cut short");
    if (stored.type() != CV_8UC3 && stored.type() != CV_16UC3)
        unsupported("its pixels are not 8 or 16 bits; convert it to 8-bit grey or RGB");
    return stored;
}

cv::Mat scaled_to_8_bits(const cv::Mat &deep)
{
    cv::Mat bgr(deep.rows, deep.cols, CV_8UC3);
    uint32_t used = 0;
    for (int y = 0; y < deep.rows; y++) {
        const uint16_t *const row = deep.ptr<uint16_t>(y);
        for (int i = 0; i < 3 * deep.cols; i++) {
            used |= row[i];
            bgr.ptr(y)[i] = level_of(row[i], white_of_16_bits);
        }
    }
    require_depth(used);
    return bgr;
}

cv::Mat turned(const cv::Mat &stored, uint32_t orientation)
{
    const auto width = static_cast<uint32_t>(stored.cols),
               height = static_cast<uint32_t>(stored.rows);
    const vdna_turn turn = vdna_turn_of(orientation, width, height);
    cv::Mat upright(static_cast<int>(turn.height), static_cast<int>(turn.width), CV_8UC3);
    for (uint32_t y = 0; y < height; y++)
        vdna_turn_row(&turn, stored.ptr(static_cast<int>(y)), width, y, upright.data);
    return upright;
}

cv::Mat decode(Kind kind, const Bytes &file)
{
    cv::Mat bgr;
    if (kind == Kind::pnm) {
        decode_pnm(file, pnm_header(file), bgr);
        return bgr;
    }
    if (kind == Kind::tiff) {
        const std::vector<uint8_t> plain = plain_tiff(file);
        bgr = decode_as_stored(plain.data(), plain.size());
    } else {
        bgr = decode_as_stored(file.data(), file.size());
    }
    return bgr.depth() == CV_8U ? bgr : scaled_to_8_bits(bgr);
}

} // namespace

vdna_image FileConverter::convert(const uint8_t *data, size_t size)
{
    if (vdna_jpeg_begins(data, size))
        return {data, size, 0, 0, 0, VDNA_PIXEL_MJPG};
    if (size == 0)
        throw fail::Failure(VDNA_ERR_FORMAT, "picture: has no bytes");
    const Bytes file(data, size);
    const Kind kind = kind_of(file);
    const Header header = header_of(kind, file);
    check_sides(header.width, header.height, VDNA_IMAGE_PIXELS_MAX);
    if (size > INT32_MAX)
        unsupported("more than 2 GiB");
    bgr_ = decode(kind, file);
    if (header.orientation != VDNA_UPRIGHT)
        bgr_ = turned(bgr_, header.orientation);
    return image_of(bgr_);
}

} // namespace vdna::picture
