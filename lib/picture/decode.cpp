#include "decode.hpp"

#include <algorithm>
#include <cctype>
#include <string>

#include "exif.h"
#include "failure.hpp"
#include "jpeg.h"
#include "levels.hpp"
#include "limits.hpp"
#include "pixel_formats.hpp"

namespace vdna::picture
{

namespace
{

constexpr uint32_t bgr_channels = VDNA_TURN_CHANNELS;

size_t longest_row(uint32_t max_pixels)
{
    return size_t{bgr_channels} * std::min(max_pixels, VDNA_IMAGE_SIDE_MAX);
}

// Without the spaces that fill up a short name.
std::string fourcc_text(uint32_t pixelformat)
{
    std::string text;
    for (int shift = 0; shift < 32; shift += 8) {
        const auto letter = static_cast<unsigned char>(pixelformat >> shift);
        text += std::isprint(letter) ? static_cast<char>(letter) : '?';
    }
    return text.substr(0, text.find_last_not_of(' ') + 1);
}

// "MJPG, GREY or RGB3"
std::string known_formats()
{
    std::string text;
    for (const PixelFormat &format : pixel_formats) {
        const bool last = &format + 1 == pixel_formats.end();
        text += (text.empty() ? "" : last ? " or " : ", ") + fourcc_text(format.fourcc);
    }
    return text;
}

const PixelFormat &format_of(uint32_t fourcc)
{
    const auto *const found =
        std::find_if(pixel_formats.begin(), pixel_formats.end(),
                     [&](const PixelFormat &format) { return format.fourcc == fourcc; });
    if (found == pixel_formats.end())
        throw fail::Failure(VDNA_ERR_UNSUPPORTED, "picture: unknown pixel format '" +
                                                      fourcc_text(fourcc) + "'; expected " +
                                                      known_formats());
    return *found;
}

// "picture: GREY 640x480, row stride 640, 307200 bytes: "
std::string layout_text(const vdna_image &image)
{
    return "picture: " + fourcc_text(image.pixelformat) + " " + std::to_string(image.width) + "x" +
           std::to_string(image.height) + ", row stride " + std::to_string(image.row_stride) +
           ", " + std::to_string(image.size) + " bytes: ";
}

[[noreturn]] void refuse_layout(const vdna_image &image, const std::string &expected)
{
    throw fail::Failure(VDNA_ERR_FORMAT, layout_text(image) + "expected " + expected);
}

// Bytes from row to row, checked against the size of a row.
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

// Check rows of packed pixels; the last row may end at its last pixel. Returns the stride.
size_t check_packed(const vdna_image &image, size_t row_bytes)
{
    const size_t stride = stride_of(image, row_bytes);
    need_bytes(image, stride * (image.height - 1) + row_bytes);
    return stride;
}

// Drivers exist that call 16-bit pixels by the name of an 8-bit format. Then a row in the data has
// twice the bytes, and perhaps some that align it. Half of a larger picture looks the same if its
// size counts whole rows; it may end at its last pixel instead. A stride beyond twice the row that
// is a power of two is an alignment of its own, and short rows may be aligned to anything.
void refuse_two_bytes_a_channel(const vdna_image &image, size_t row_bytes)
{
    constexpr size_t alignment = 64;
    const size_t wide = 2 * row_bytes, stride = image.row_stride;
    const bool padded = stride > row_bytes;
    const bool twice = padded ? stride == wide && image.size >= wide * image.height
                              : image.size == wide * image.height;
    const bool aligned = stride > wide && stride < wide + alignment &&
                         (stride & (stride - 1)) != 0 && image.size >= stride * image.height;
    if (row_bytes >= alignment && (twice || aligned))
        throw fail::Failure(VDNA_ERR_FORMAT,
                            layout_text(image) +
                                "two bytes a channel? this format has one; name 16-bit grey Y16, "
                                "Y14, Y12 or Y10 by its significant bits, or send 8-bit pixels");
}

void require_jpeg(const vdna_image &image)
{
    if (vdna_jpeg_begins(image.data, image.size))
        return;
    if (image.pixelformat == VDNA_PIXEL_MJPG)
        throw fail::Failure(VDNA_ERR_FORMAT, "picture: MJPG must hold a JPEG picture");
    throw fail::Failure(
        VDNA_ERR_UNSUPPORTED,
        "picture: is encoded, but no JPEG; expected JPEG or a camera's pixel format; decode "
        "it first and hand over its pixels as BGR3");
}

// The size of a stored picture after its turn.
Size upright(uint32_t orientation, Size stored)
{
    const vdna_turn turn = vdna_turn_of(orientation, stored.width, stored.height);
    return {turn.width, turn.height};
}

// By how much both sides can be divided without getting below `least`.
uint32_t divisor_for(Size picture, Size least)
{
    uint32_t divisor = 8;
    while (divisor > 1 && (vdna_jpeg_reduced(picture.width, divisor) < least.width ||
                           vdna_jpeg_reduced(picture.height, divisor) < least.height))
        divisor /= 2;
    return divisor;
}

} // namespace

Decoder::Decoder(uint32_t max_pixels)
    // Left uninitialised, so that it is not resident before a picture needs it.
    : max_pixels_(max_pixels), bgr_(new uint8_t[size_t{bgr_channels} * max_pixels]),
      row_(new uint8_t[longest_row(max_pixels)])
{
}

uint64_t Decoder::bytes_max(uint32_t max_pixels)
{
    // libjpeg keeps all coefficients of a progressive picture, two bytes each for up to three
    // components, whose sides it rounds up to whole blocks of at most 32 pixels. Other pictures
    // take a few rows.
    constexpr uint64_t block = 32, components = 3, row_bytes = 4u << 20;
    const uint64_t edge = VDNA_IMAGE_SIDE_MAX + max_pixels / VDNA_IMAGE_SIDE_MAX + block;
    const uint64_t padded = max_pixels + block * edge;
    return bgr_channels * uint64_t{max_pixels} + longest_row(max_pixels) + 2 * components * padded +
           row_bytes;
}

vdna_pixels Decoder::decode(const vdna_image &image, Size least)
{
    if (!image.data || image.size == 0)
        throw fail::Failure(VDNA_ERR_FORMAT, "picture: has no bytes");
    if (image.pixelformat == VDNA_PIXEL_ENCODED)
        return encoded(image, least);
    const PixelFormat &format = format_of(image.pixelformat);
    if (format.arrangement == Arrangement::jpeg)
        return encoded(image, least);
    if (format.arrangement == Arrangement::packed)
        return packed(image, format);
    if (format.arrangement == Arrangement::words)
        return words(image, format);
    if (format.arrangement == Arrangement::yuv422)
        return yuv422(image, format);
    return yuv420(image, format);
}

vdna_pixels Decoder::own_bgr(uint32_t width, uint32_t height) const
{
    return {bgr_.get(), size_t{width} * bgr_channels, width, height, bgr_channels, {2, 1, 0}};
}

// Packed pixels are used in place.
vdna_pixels Decoder::packed(const vdna_image &image, const PixelFormat &format) const
{
    check_sides(image.width, image.height, max_pixels_);
    const size_t row_bytes = size_t{image.width} * format.channels;
    refuse_two_bytes_a_channel(image, row_bytes);
    const size_t stride = check_packed(image, row_bytes);
    const auto [red, green, blue] = format.rgb;
    return {image.data, stride, image.width, image.height, format.channels, {red, green, blue}};
}

vdna_pixels Decoder::words(const vdna_image &image, const PixelFormat &format)
{
    check_sides(image.width, image.height, max_pixels_);
    const size_t stride = check_packed(image, size_t{2} * image.width);
    uint32_t used = 0;
    for (size_t y = 0; y < image.height; y++)
        used |= words_to_grey(image.data + y * stride, image.width, format.bits,
                              bgr_.get() + y * image.width);
    if (used >> format.bits != 0)
        throw fail::Failure(VDNA_ERR_FORMAT, layout_text(image) + "has values of more than " +
                                                 std::to_string(format.bits) +
                                                 " bits; name the format by its significant bits");
    const uint32_t bits = format.bits == 16 ? fewer_than_16_bits(used) : 0;
    if (bits != 0)
        throw fail::Failure(VDNA_ERR_UNSUPPORTED,
                            layout_text(image) + fewer_bits_text(bits) +
                                "name the format by its significant bits, Y10, Y12 or Y14");
    return {bgr_.get(), image.width, image.width, image.height, 1, {0, 0, 0}};
}

vdna_pixels Decoder::encoded(const vdna_image &image, Size least)
{
    require_jpeg(image);
    char reason[VDNA_JPEG_REASON_MAX];
    vdna_jpeg_shape stored;
    if (!vdna_jpeg_shape_of(image.data, image.size, &stored, reason))
        throw fail::Failure(VDNA_ERR_FORMAT, std::string("JPEG picture: ") + reason);
    check_sides(stored.width, stored.height, max_pixels_);
    if (stored.channels == 4)
        throw fail::Failure(VDNA_ERR_UNSUPPORTED, "JPEG picture: its colours are CMYK, inks of "
                                                  "print; convert it to RGB");
    const uint32_t orientation = vdna_jpeg_orientation(image.data, image.size);
    const uint32_t divisor =
        divisor_for(upright(orientation, {stored.width, stored.height}), least);
    const vdna_turn turn = vdna_turn_of(orientation, vdna_jpeg_reduced(stored.width, divisor),
                                        vdna_jpeg_reduced(stored.height, divisor));
    if (!vdna_jpeg_decode(image.data, image.size, divisor, &turn, row_.get(), bgr_.get(), reason))
        throw fail::Failure(VDNA_ERR_FORMAT, std::string("JPEG picture: ") + reason);
    return own_bgr(turn.width, turn.height);
}

vdna_pixels Decoder::yuv422(const vdna_image &image, const PixelFormat &format)
{
    if (image.width % 2 != 0)
        refuse_layout(image, "an even width");
    check_sides(image.width, image.height, max_pixels_);
    const size_t stride = check_packed(image, size_t{2} * image.width);
    const vdna_pixels pixels = own_bgr(image.width, image.height);
    for (size_t y = 0; y < image.height; y++) {
        const uint8_t *const row = image.data + y * stride;
        format.row_to_bgr(row, row, row, image.width, bgr_.get() + y * pixels.stride);
    }
    return pixels;
}

vdna_pixels Decoder::yuv420(const vdna_image &image, const PixelFormat &format)
{
    check_sides(image.width, image.height, max_pixels_);
    const size_t stride = stride_of(image, image.width), rows = image.height;
    if (image.width % 2 != 0 || rows % 2 != 0 || stride % 2 != 0)
        refuse_layout(image, "an even width, height and row stride");
    need_bytes(image, stride * (rows + rows / 2));

    const bool together = format.arrangement == Arrangement::yuv420_together;
    const size_t chroma_stride = together ? stride : stride / 2;
    const uint8_t *const second = image.data + stride * rows;
    const uint8_t *const third = together ? second : second + chroma_stride * (rows / 2);
    const vdna_pixels pixels = own_bgr(image.width, image.height);
    for (size_t y = 0; y < rows; y++) {
        const size_t chroma = y / 2 * chroma_stride;
        format.row_to_bgr(image.data + y * stride, second + chroma, third + chroma, image.width,
                          bgr_.get() + y * pixels.stride);
    }
    return pixels;
}

} // namespace vdna::picture
