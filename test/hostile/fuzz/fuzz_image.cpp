// Any bytes as a picture of any format, and as a file of any kind: it is either decoded or refused
// with a Failure.
//
// The first 13 bytes are the fields of vdna_image (pixel format, width, height, row stride); the
// rest is its data.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "failure.hpp"
#include "picture/decode.hpp"
#include "picture/files/file_converter.hpp"
#include "picture/mean_grey.hpp"
#include "picture/pixel_formats.hpp"

namespace
{

// Not pixel formats: the data is a file that the tools convert first; no format that we know.
constexpr uint32_t file = VDNA_FOURCC('F', 'I', 'L', 'E'),
                   unknown = VDNA_FOURCC('N', 'O', 'N', 'E');
constexpr size_t others = 3; // before the pixel formats

std::vector<uint32_t> formats_tried()
{
    std::vector<uint32_t> tried = {file, VDNA_PIXEL_ENCODED, unknown};
    for (const vdna::picture::PixelFormat &format : vdna::picture::pixel_formats)
        tried.push_back(format.fourcc);
    return tried;
}
const std::vector<uint32_t> formats = formats_tried();
const char *const encodings[] = {".jpg", ".png", ".webp", ".bmp", ".ppm", ".tiff"};

constexpr size_t head_size = 13;
constexpr uint32_t side = 8;
constexpr uint32_t pixels_max = 1 << 20;

// One seed per encoding, then one per pixel format; that of MJPG is refused.
std::vector<uint8_t> seed_of(size_t index)
{
    std::vector<uint8_t> seed(head_size);
    std::memcpy(&seed[1], &side, sizeof side);
    std::memcpy(&seed[5], &side, sizeof side);
    std::vector<uint8_t> bytes(size_t{side} * side * 4, 128); // enough for the widest format
    if (index < std::size(encodings))
        cv::imencode(encodings[index], cv::Mat(side, side, CV_8UC3, cv::Scalar(10, 100, 200)),
                     bytes);
    else
        seed[0] = static_cast<uint8_t>(index - std::size(encodings) + others);
    seed.insert(seed.end(), bytes.begin(), bytes.end());
    return seed;
}

// The decoder's input: a file as converted by the tools, anything else unchanged.
vdna_image camera_image(const vdna_image &image, vdna::picture::FileConverter &converter)
{
    return image.pixelformat == file ? converter.convert(image.data, image.size) : image;
}

} // namespace

extern "C" size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity)
{
    if (index >= std::size(encodings) + formats.size() - others)
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

    // Small, because sanitizers mark all of its memory anew for each input.
    vdna::picture::Decoder decoder(pixels_max);
    vdna::picture::FileConverter converter;
    try {
        const vdna_pixels pixels = decoder.decode(camera_image(image, converter));
        const float grey = vdna::picture::mean_grey(pixels);
        if (pixels.width * pixels.height > pixels_max || !(grey >= 0.0f && grey <= 255.0f))
            std::abort();
    } catch (const vdna::fail::Failure &) {
    }
    return 0;
}
