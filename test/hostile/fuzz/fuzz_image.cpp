// Any bytes as a picture of any format, and as a file of any kind: it is either decoded or refused
// with a Failure, and a JPEG that is decoded in full is decoded reduced, with sides that were asked
// for. Any bytes as an EXIF block, and in a JPEG, PNG or TIFF file: it states one of
// eight orientations.
//
// The first 13 bytes are the fields of vdna_image (pixel format, width, height, row stride); the
// rest is its data. A JPEG does not need width and height: they are those that are asked for.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <vector>

#include <exif_block.hpp>
#include <opencv2/imgcodecs.hpp>
#include <tiff_tag.hpp>

#include "failure.hpp"
#include "picture/decode.hpp"
#include "picture/exif.h"
#include "picture/files/file_converter.hpp"
#include "picture/mean_grey.hpp"
#include "picture/pixel_formats.hpp"

namespace
{

// Not pixel formats: the data is a file that the tools convert first; no format that we know; an
// EXIF block.
constexpr uint32_t file = VDNA_FOURCC('F', 'I', 'L', 'E'),
                   unknown = VDNA_FOURCC('N', 'O', 'N', 'E'),
                   exif = VDNA_FOURCC('E', 'X', 'I', 'F');
constexpr uint8_t exif_index = 3;
constexpr size_t others = 4; // before the pixel formats

std::vector<uint32_t> formats_tried()
{
    std::vector<uint32_t> tried = {file, VDNA_PIXEL_ENCODED, unknown, exif};
    for (const vdna::picture::PixelFormat &format : vdna::picture::pixel_formats)
        tried.push_back(format.fourcc);
    return tried;
}
const std::vector<uint32_t> formats = formats_tried();
const char *const encodings[] = {".jpg", ".png", ".webp", ".bmp", ".ppm", ".tiff"};

// More seeds: files that are turned, of 16 bits, text, and a block alone.
enum Seed { turned_jpeg, turned_tiff, deep_png, deep_tiff, pnm_text, block_alone, more_seeds };

constexpr size_t head_size = 13;
constexpr uint32_t side = 8;
constexpr uint32_t pixels_max = 1 << 20;

std::vector<uint8_t> encoded(const char *encoding, int type = CV_8UC3, double scale = 1)
{
    std::vector<uint8_t> bytes;
    cv::imencode(encoding, cv::Mat(side, side, type, scale * cv::Scalar(10, 100, 200)), bytes);
    return bytes;
}

std::vector<uint8_t> another_seed(size_t index)
{
    switch (index) {
    case turned_jpeg:
        return jpeg_with_exif(encoded(".jpg"), exif_block(6));
    case turned_tiff:
        return tiff_with(encoded(".tiff"), 274, 7);
    case deep_png:
        return encoded(".png", CV_16UC3, 257);
    case deep_tiff:
        return encoded(".tiff", CV_16UC1, 6000);
    case pnm_text:
        return {'P', '2', ' ', '2', ' ', '1', ' ', '9', ' ', '0', ' ', '5', ' '};
    default:
        return exif_block(8, true);
    }
}

// One seed per encoding, then one per pixel format, of which that of MJPG is refused, then more.
std::vector<uint8_t> seed_of(size_t index)
{
    const size_t raw = formats.size() - others;
    std::vector<uint8_t> seed(head_size);
    std::memcpy(&seed[1], &side, sizeof side);
    std::memcpy(&seed[5], &side, sizeof side);
    std::vector<uint8_t> bytes(size_t{side} * side * 4); // black, enough for the widest format
    if (index < std::size(encodings)) {
        bytes = encoded(encodings[index]);
    } else if (index < std::size(encodings) + raw) {
        seed[0] = static_cast<uint8_t>(index - std::size(encodings) + others);
    } else {
        index -= std::size(encodings) + raw;
        bytes = another_seed(index);
        seed[0] = index == block_alone ? exif_index : 0;
        seed[1] = seed[5] = side / 2; // reduces a JPEG
    }
    seed.insert(seed.end(), bytes.begin(), bytes.end());
    return seed;
}

// The decoder's input: a file as converted by the tools, anything else unchanged.
vdna_image camera_image(const vdna_image &image, vdna::picture::FileConverter &converter)
{
    return image.pixelformat == file ? converter.convert(image.data, image.size) : image;
}

// A side of a whole picture, reduced as little as its length in the reduced picture shows.
bool is_reduced(uint32_t length, uint32_t whole, uint32_t least)
{
    for (uint32_t divisor = 1; divisor <= 8; divisor *= 2)
        if (length == whole / divisor + (whole % divisor != 0))
            return length >= least || length == whole;
    return false;
}

// It must not be refused: it was decoded in full.
void decode_reduced(vdna::picture::Decoder &decoder, const vdna_image &image,
                    vdna::picture::Size least, const vdna_pixels &whole) noexcept
{
    const vdna_pixels pixels = decoder.decode(image, least);
    if (!is_reduced(pixels.width, whole.width, least.width) ||
        !is_reduced(pixels.height, whole.height, least.height))
        std::abort();
}

} // namespace

extern "C" size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity)
{
    if (index >= std::size(encodings) + formats.size() - others + more_seeds)
        return 0;
    const std::vector<uint8_t> seed = seed_of(index);
    if (seed.size() > capacity)
        return 0;
    std::memcpy(out, seed.data(), seed.size());
    return seed.size();
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size < head_size)
        return 0;
    vdna_image image = {data + head_size, size - head_size, 0, 0, 0, 0};
    image.pixelformat = formats[data[0] % formats.size()];
    std::memcpy(&image.width, data + 1, sizeof image.width);
    std::memcpy(&image.height, data + 5, sizeof image.height);
    std::memcpy(&image.row_stride, data + 9, sizeof image.row_stride);

    const uint32_t orientation = image.pixelformat == exif
                                     ? vdna_exif_orientation(image.data, image.size)
                                     : vdna_jpeg_orientation(image.data, image.size);
    if (orientation < 1 || orientation > 8)
        std::abort();

    // Small, because sanitizers mark all of its memory anew for each input.
    vdna::picture::Decoder decoder(pixels_max);
    vdna::picture::FileConverter converter;
    try {
        const vdna_image sent = camera_image(image, converter);
        const vdna_pixels pixels = decoder.decode(sent);
        const float grey = vdna::picture::mean_grey(pixels);
        if (pixels.width * pixels.height > pixels_max || !(grey >= 0.0f && grey <= 255.0f))
            std::abort();
        if (sent.pixelformat == VDNA_PIXEL_ENCODED || sent.pixelformat == VDNA_PIXEL_MJPG)
            decode_reduced(decoder, sent, {image.width, image.height}, pixels);
    } catch (const vdna::fail::Failure &) {
    }
    return 0;
}
