// Decoding: every pixel format gives the picture, and bytes that are none are refused.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include <cmocka.hpp>
#include <counted_new.hpp>
#include <exif_block.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <jpeglib.h> // after <cstdio>

#include "failure.hpp"
#include "noise.hpp"
#include "picture/decode.hpp"
#include "picture/mean_grey.hpp"
#include "picture/pixel_formats.hpp"

using namespace vdna;
using picture::Decoder;

using Bytes = std::vector<uint8_t>;

// Smooth in both directions, so that chroma at half resolution loses little.
static const int width = 32, height = 24;
static cv::Vec3b rgb_at(int x, int y)
{
    return {cv::saturate_cast<uint8_t>(60 + 4 * x), cv::saturate_cast<uint8_t>(40 + 5 * y),
            cv::saturate_cast<uint8_t>(200 - 3 * x)};
}

static cv::Mat bgr_picture()
{
    cv::Mat picture(height, width, CV_8UC3);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const cv::Vec3b rgb = rgb_at(x, y);
            picture.at<cv::Vec3b>(y, x) = {rgb[2], rgb[1], rgb[0]};
        }
    return picture;
}

// BT.601 with 16..235: Y, U, V of one pixel, from the textbook.
static cv::Vec3b yuv_at(int x, int y)
{
    const cv::Vec3b rgb = rgb_at(x, y);
    const double r = rgb[0], g = rgb[1], b = rgb[2];
    return {cv::saturate_cast<uint8_t>(16 + 0.257 * r + 0.504 * g + 0.098 * b),
            cv::saturate_cast<uint8_t>(128 - 0.148 * r - 0.291 * g + 0.439 * b),
            cv::saturate_cast<uint8_t>(128 + 0.439 * r - 0.368 * g - 0.071 * b)};
}

static vdna_image image_of(const Bytes &bytes, uint32_t pixelformat, uint32_t stride = 0)
{
    return {bytes.data(), bytes.size(), width, height, stride, pixelformat};
}

// Rows of `row` bytes, made by `byte_at(column, y)`, padded with 0xEE up to `stride`.
static void append_rows(Bytes &bytes, int rows, int row, int stride,
                        const std::function<int(int, int)> &byte_at)
{
    for (int y = 0; y < rows; y++)
        for (int i = 0; i < stride; i++)
            bytes.push_back(static_cast<uint8_t>(i < row ? byte_at(i, y) : 0xEE));
}

static Bytes packed(int channels, bool bgr, int padding)
{
    Bytes bytes;
    append_rows(bytes, height, channels * width, channels * width + padding, [&](int i, int y) {
        const int channel = i % channels;
        return channel == 3 ? 0x55 : rgb_at(i / channels, y)[bgr ? 2 - channel : channel];
    });
    return bytes;
}

static Bytes yuv422(bool chroma_first, int padding)
{
    Bytes bytes;
    append_rows(bytes, height, 2 * width, 2 * width + padding, [&](int i, int y) {
        const bool is_chroma = (i % 2 == 0) == chroma_first;
        const int chroma = i % 4 < 2 ? 1 : 2;
        return yuv_at(i / 2 - (is_chroma ? i / 2 % 2 : 0), y)[is_chroma ? chroma : 0];
    });
    return bytes;
}

static void append_luma(Bytes &bytes, int padding)
{
    append_rows(bytes, height, width, width + padding,
                [](int x, int y) { return yuv_at(x, y)[0]; });
}

static Bytes i420(int padding)
{
    Bytes bytes;
    append_luma(bytes, padding);
    for (const int plane : {1, 2})
        append_rows(bytes, height / 2, width / 2, (width + padding) / 2,
                    [&](int x, int y) { return yuv_at(2 * x, 2 * y)[plane]; });
    return bytes;
}

static Bytes nv12(int padding)
{
    Bytes bytes;
    append_luma(bytes, padding);
    append_rows(bytes, height / 2, width, width + padding,
                [](int i, int y) { return yuv_at(i / 2 * 2, 2 * y)[1 + i % 2]; });
    return bytes;
}

// A colour format, how it is tried: rows of `row` bytes (of luma, where it has planes) that
// make_bytes writes with `padding` after each, how far from the picture a pixel may be, and the
// cv:: conversion whose bits it must have.
struct Trial {
    uint32_t fourcc;
    int row;
    std::function<Bytes(int padding)> make_bytes;
    int tolerance = 0;
    int conversion = -1;
};

// Rounding to YUV and back costs 2 levels; chroma of the neighbour up to 4 * 1.6 more.
static const std::vector<Trial> trials = {
    {VDNA_PIXEL_RGB3, 3 * width, [](int padding) { return packed(3, false, padding); }},
    {VDNA_PIXEL_BGR3, 3 * width, [](int padding) { return packed(3, true, padding); }},
    {VDNA_PIXEL_RGB4, 4 * width, [](int padding) { return packed(4, false, padding); }},
    {VDNA_PIXEL_BGR4, 4 * width, [](int padding) { return packed(4, true, padding); }},
    {VDNA_PIXEL_YUYV, 2 * width, [](int padding) { return yuv422(false, padding); }, 6,
     cv::COLOR_YUV2BGR_YUYV},
    {VDNA_PIXEL_UYVY, 2 * width, [](int padding) { return yuv422(true, padding); }, 6,
     cv::COLOR_YUV2BGR_UYVY},
    {VDNA_PIXEL_I420, width, i420, 9, cv::COLOR_YUV2BGR_I420},
    {VDNA_PIXEL_YU12, width, i420, 9, cv::COLOR_YUV2BGR_I420},
    {VDNA_PIXEL_NV12, width, nv12, 9, cv::COLOR_YUV2BGR_NV12},
};

static Bytes encoded(const char *extension)
{
    Bytes bytes;
    assert_true(cv::imencode(extension, bgr_picture(), bytes));
    return bytes;
}

// Every channel of every pixel is within `tolerance` of the picture.
static void assert_is_the_picture(const vdna_image &image, int tolerance)
{
    Decoder decoder;
    const vdna_pixels pixels = decoder.decode(image);
    assert_int_equal(pixels.height, height);
    assert_int_equal(pixels.width, width);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            for (int c = 0; c < 3; c++) {
                const uint8_t *row = pixels.data + static_cast<size_t>(y) * pixels.stride;
                const uint8_t *pixel = row + static_cast<size_t>(x) * pixels.channels;
                assert_in_range(pixel[pixels.rgb[c]] + 64 - rgb_at(x, y)[c], 64 - tolerance,
                                64 + tolerance);
            }
}

// The reason why `image` is refused; the status must be `status`.
static std::string refusal(const vdna_image &image, vdna_status status,
                           uint32_t max_pixels = VDNA_IMAGE_PIXELS_MAX)
{
    Decoder decoder(max_pixels);
    try {
        decoder.decode(image);
    } catch (const vdna::fail::Failure &failure) {
        assert_int_equal(failure.status(), status);
        return failure.what();
    }
    fail_msg("%ux%u, stride %u, %zu bytes: was decoded", image.width, image.height,
             image.row_stride, image.size);
    return "";
}

static void every_colour_format_is_tried(void **)
{
    for (const picture::PixelFormat &format : picture::pixel_formats) {
        const bool is_colour = format.arrangement != picture::Arrangement::jpeg &&
                               format.arrangement != picture::Arrangement::words &&
                               format.channels != 1;
        const auto tried = std::count_if(trials.begin(), trials.end(), [&](const Trial &trial) {
            return trial.fourcc == format.fourcc;
        });
        if (tried != is_colour)
            fail_msg("%.4s: has %d trials, expected %d",
                     reinterpret_cast<const char *>(&format.fourcc), static_cast<int>(tried),
                     is_colour);
    }
}

static void every_colour_format_gives_the_picture_with_and_without_padding(void **)
{
    for (const Trial &trial : trials)
        for (const int padding : {0, 2, 5, 6}) {
            if (trial.row == width && padding % 2 != 0)
                continue; // 4:2:0 has an even stride
            const Bytes bytes = trial.make_bytes(padding);
            const auto stride = static_cast<uint32_t>(padding ? trial.row + padding : 0);
            assert_is_the_picture(image_of(bytes, trial.fourcc, stride), trial.tolerance);
        }
}

// What OpenCV makes of packed 4:2:2, or of 4:2:0 whose padding belongs to the picture.
static cv::Mat by_opencv(const Bytes &bytes, cv::Size size, size_t stride, const Trial &trial)
{
    auto *const data = const_cast<uint8_t *>(bytes.data());
    const cv::Mat raw =
        trial.row == 2 * width
            ? cv::Mat(size, CV_8UC2, data, stride)
            : cv::Mat(size.height * 3 / 2, static_cast<int>(stride), CV_8UC1, data, stride);
    cv::Mat bgr;
    cv::cvtColor(raw, bgr, trial.conversion);
    return bgr.colRange(0, size.width);
}

static void assert_as_opencv(const Bytes &bytes, cv::Size size, size_t stride, const Trial &trial)
{
    const cv::Mat expected = by_opencv(bytes, size, stride, trial);
    const auto columns = static_cast<uint32_t>(size.width),
               rows = static_cast<uint32_t>(size.height);
    Decoder decoder(columns * rows);
    const vdna_pixels pixels = decoder.decode(
        {bytes.data(), bytes.size(), columns, rows, static_cast<uint32_t>(stride), trial.fourcc});
    assert_true((pixels.rgb[0] == 2 && pixels.rgb[1] == 1 && pixels.rgb[2] == 0));
    for (int y = 0; y < size.height; y++)
        if (std::memcmp(pixels.data + static_cast<size_t>(y) * pixels.stride, expected.ptr(y),
                        size_t{3} * columns) != 0)
            fail_msg("%.4s %dx%d, stride %zu: row %d is not what OpenCV gives",
                     reinterpret_cast<const char *>(&trial.fourcc), size.width, size.height, stride,
                     y);
}

static void yuv_is_converted_as_opencv_does_to_the_last_bit(void **)
{
    for (const Trial &trial : trials) {
        if (trial.conversion < 0)
            continue;
        const int row = trial.row / width, planes = row == 1 ? 3 : 2; // halves of the height
        // Around the number of pixels that are converted at once, and beyond any vector.
        for (const int columns : {2, 4, 6, 8, 14, 30, 62, 64, 66, 126, 128, 130, 258, 640})
            for (const int rows : {2, 6})
                for (const int padding : {0, 2, 10}) {
                    const auto stride = static_cast<size_t>(columns * row + padding);
                    const auto lines = static_cast<size_t>(rows * planes / 2);
                    assert_as_opencv(noise(stride * lines), {columns, rows}, stride, trial);
                }
    }
}

static void every_colour_is_converted_as_opencv_does(void **)
{
    const Trial &yuyv = *std::find_if(trials.begin(), trials.end(), [](const Trial &trial) {
        return trial.fourcc == VDNA_PIXEL_YUYV;
    });
    // Every U with every V, each with 256 Y, in rows of one U and V.
    Bytes bytes(size_t{512} * 256);
    for (int u = 0; u < 256; u++) {
        for (size_t v = 0; v < 256; v++)
            for (size_t y = 0; y < 256; y++) {
                bytes[512 * v + 2 * y] = static_cast<uint8_t>(y);
                bytes[512 * v + 2 * y + 1] =
                    static_cast<uint8_t>(y % 2 ? v : static_cast<size_t>(u));
            }
        assert_as_opencv(bytes, {256, 256}, 512, yuyv);
    }
}

static void colours_are_those_of_the_textbook(void **)
{
    struct Case {
        uint8_t y, u, v;
        int red, green, blue;
    };
    // BT.601 with 16..235, by hand: 1.164 (Y - 16) + 1.596 (V - 128), and so on.
    const Case cases[] = {
        {16, 128, 128, 0, 0, 0},        {235, 128, 128, 255, 255, 255},
        {126, 128, 128, 128, 128, 128}, {81, 90, 240, 254, 0, 0},
        {145, 54, 34, 0, 255, 1},       {41, 240, 110, 0, 0, 255},
        {0, 128, 128, 0, 0, 0}, // below black is black
        {255, 128, 128, 255, 255, 255},
    };
    for (const Case &c : cases) {
        const Bytes bytes = {c.y, c.u, c.y, c.v};
        Decoder decoder;
        const vdna_pixels pixels =
            decoder.decode({bytes.data(), bytes.size(), 2, 1, 0, VDNA_PIXEL_YUYV});
        const int expected[] = {c.blue, c.green, c.red, c.blue, c.green, c.red};
        for (size_t i = 0; i < 6; i++)
            assert_in_range(pixels.data[i] + 1, expected[i], expected[i] + 2);
    }
}

static void the_mean_grey_level_has_the_bits_of_opencvs_mean(void **)
{
    const uint32_t formats[] = {VDNA_PIXEL_GREY, VDNA_PIXEL_RGB3, VDNA_PIXEL_BGR4};
    for (const uint32_t format : formats)
        for (const int columns : {1, 7, 63, 64, 65, 200, 641})
            for (const int rows : {1, 3, 50}) {
                const int channels = format == VDNA_PIXEL_GREY   ? 1
                                     : format == VDNA_PIXEL_RGB3 ? 3
                                                                 : 4;
                const int stride = columns * channels + 3;
                const Bytes bytes = noise(static_cast<size_t>(stride * rows));
                const cv::Mat pixels(rows, columns, CV_8UC(channels),
                                     const_cast<uint8_t *>(bytes.data()),
                                     static_cast<size_t>(stride));
                Decoder decoder;
                const vdna_pixels decoded = decoder.decode(
                    {bytes.data(), bytes.size(), static_cast<uint32_t>(columns),
                     static_cast<uint32_t>(rows), static_cast<uint32_t>(stride), format});
                const cv::Scalar mean = cv::mean(pixels);
                const auto of = [&](size_t c) { return mean[static_cast<int>(decoded.rgb[c])]; };
                const auto expected =
                    static_cast<float>(0.299 * of(0) + 0.587 * of(1) + 0.114 * of(2));
                const float found = picture::mean_grey(decoded);
                assert_memory_equal(&found, &expected, sizeof found);
            }
}

static void a_jpeg_gives_the_picture_with_and_without_the_name_of_its_format(void **)
{
    assert_is_the_picture(image_of(encoded(".jpg"), VDNA_PIXEL_ENCODED), 12);
    assert_is_the_picture(image_of(encoded(".jpg"), VDNA_PIXEL_MJPG), 12);
}

static void an_encoded_picture_that_is_no_jpeg_is_refused_with_what_to_do(void **)
{
    const Bytes png = encoded(".png");
    const std::string reason = refusal(image_of(png, VDNA_PIXEL_ENCODED), VDNA_ERR_UNSUPPORTED);
    assert_true(reason.find("decode it first") != std::string::npos);
    refusal(image_of(png, VDNA_PIXEL_MJPG), VDNA_ERR_FORMAT);
    refusal(image_of({0xFF, 0xD8}, VDNA_PIXEL_ENCODED), VDNA_ERR_UNSUPPORTED);
    refusal(image_of({}, VDNA_PIXEL_ENCODED), VDNA_ERR_FORMAT);
}

static void a_picture_of_one_pixel_too_many_is_refused_in_every_format(void **)
{
    constexpr uint32_t pixels = width * height;
    const Bytes jpeg = encoded(".jpg"), raw(size_t{4} * pixels, 0);
    std::vector<vdna_image> images;
    for (const picture::PixelFormat &format : picture::pixel_formats) {
        const bool is_jpeg = format.arrangement == picture::Arrangement::jpeg;
        images.push_back(image_of(is_jpeg ? jpeg : raw, format.fourcc));
    }
    for (const vdna_image &image : images) {
        Decoder decoder(pixels);
        const vdna_pixels decoded = decoder.decode(image);
        assert_int_equal(decoded.width * decoded.height, pixels);
        const std::string reason = refusal(image, VDNA_ERR_UNSUPPORTED, pixels - 1);
        assert_true(reason.find(std::to_string(pixels - 1)) != std::string::npos);
    }
    // Padding is not a pixel.
    Decoder(pixels).decode(image_of(raw, VDNA_PIXEL_I420, width + 2));
}

static void grey_pictures_have_three_equal_channels(void **)
{
    const Bytes bytes(static_cast<size_t>(width * height), 77);
    Decoder decoder;
    const vdna_pixels pixels = decoder.decode(image_of(bytes, VDNA_PIXEL_GREY));
    assert_int_equal(pixels.channels, 1);
    for (const uint32_t channel : pixels.rgb)
        assert_int_equal(channel, 0);
    assert_float_equal(picture::mean_grey(pixels), 77.0f, 1e-4f);
}

static void mean_grey_weighs_the_channels_over_the_whole_picture(void **)
{
    // One black and one coloured row: half of 0.299 * 100 + 0.587 * 200 + 0.114 * 50 = 153.
    const Bytes bytes = {0, 0, 0, 0xEE, 100, 200, 50};
    const vdna_image image = {bytes.data(), bytes.size(), 1, 2, 4, VDNA_PIXEL_RGB3};
    Decoder decoder;
    assert_float_equal(picture::mean_grey(decoder.decode(image)), 76.5f, 1e-4f);
}

static void no_picture_costs_an_allocation(void **)
{
    const Bytes jpeg = encoded(".jpg"), turned = jpeg_with_exif(jpeg, exif_block(6)),
                raw(size_t{4} * width * height, 0), bright(size_t{2} * width * height, 200);
    Decoder decoder(width * height);
    const size_t before = allocations;
    for (const picture::PixelFormat &format : picture::pixel_formats)
        for (const uint32_t rows : {2u, uint32_t{height}})
            for (const uint32_t columns : {2u, uint32_t{width}})
                if (format.arrangement != picture::Arrangement::jpeg)
                    picture::mean_grey(
                        decoder.decode({raw.data(), raw.size(), columns, rows, 0, format.fourcc}));
    picture::mean_grey(decoder.decode(image_of(jpeg, VDNA_PIXEL_MJPG)));
    picture::mean_grey(decoder.decode(image_of(turned, VDNA_PIXEL_MJPG)));
    picture::mean_grey(decoder.decode(image_of(turned, VDNA_PIXEL_MJPG), {1, 1}));
    picture::mean_grey(decoder.decode(image_of(bright, VDNA_PIXEL_Y16)));
    assert_int_equal(allocations, before);
}

static void mjpg_frames_may_lack_their_huffman_tables(void **)
{
    Bytes bytes = encoded(".jpg");
    for (size_t i = 2; i + 4 < bytes.size() && bytes[i + 1] != 0xDA;) {
        const size_t length = 2u + bytes[i + 2] * 256u + bytes[i + 3];
        const auto segment = bytes.begin() + static_cast<std::ptrdiff_t>(i);
        if (bytes[i + 1] == 0xC4)
            bytes.erase(segment, segment + static_cast<std::ptrdiff_t>(length));
        else
            i += length;
    }
    assert_is_the_picture(image_of(bytes, VDNA_PIXEL_MJPG), 12);
}

static void mjpg_frames_may_be_padded_before_and_after_the_end_marker(void **)
{
    Bytes bytes = encoded(".jpg");
    bytes.insert(bytes.end() - 2, 3, 0);
    bytes.insert(bytes.end(), 100, 0);
    assert_is_the_picture(image_of(bytes, VDNA_PIXEL_MJPG), 12);
}

static void damaged_jpeg_is_refused(void **)
{
    const Bytes whole = encoded(".jpg");
    for (const size_t size : {whole.size() / 2, whole.size() - 40, whole.size() - 2, size_t{3}}) {
        const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
        refusal(image_of(cut, VDNA_PIXEL_MJPG), VDNA_ERR_FORMAT);
        refusal(image_of(cut, VDNA_PIXEL_ENCODED), VDNA_ERR_FORMAT);
    }

    // A gap in the middle, as left by a lost piece of a message.
    Bytes hole = whole;
    const auto middle = hole.end() - 200;
    hole.erase(middle, middle + 100);
    refusal(image_of(hole, VDNA_PIXEL_MJPG), VDNA_ERR_FORMAT);
}

static void put_be16(Bytes &bytes, size_t at, int value)
{
    bytes[at] = static_cast<uint8_t>(value >> 8);
    bytes[at + 1] = static_cast<uint8_t>(value);
}

static void a_jpeg_that_claims_a_huge_picture_is_refused_unread(void **)
{
    Bytes jpeg = encoded(".jpg");
    size_t frame = 2; // SOF0: 16-bit height at 5, width at 7
    while (jpeg[frame + 1] != 0xC0)
        frame += 2u + jpeg[frame + 2] * 256u + jpeg[frame + 3];
    put_be16(jpeg, frame + 5, 60000);
    refusal(image_of(jpeg, VDNA_PIXEL_MJPG), VDNA_ERR_UNSUPPORTED);
    // Each side is within its limit, their product is not.
    put_be16(jpeg, frame + 5, 16384);
    put_be16(jpeg, frame + 7, 16384);
    refusal(image_of(jpeg, VDNA_PIXEL_MJPG), VDNA_ERR_UNSUPPORTED);
}

// A copy of decoded BGR pixels.
static cv::Mat decoded_bgr(const vdna_image &image)
{
    Decoder decoder(width * height);
    const vdna_pixels pixels = decoder.decode(image);
    assert_int_equal(pixels.channels, 3);
    return cv::Mat(static_cast<int>(pixels.height), static_cast<int>(pixels.width), CV_8UC3,
                   const_cast<uint8_t *>(pixels.data), pixels.stride)
        .clone();
}

static void assert_same(const cv::Mat &found, const cv::Mat &expected)
{
    assert_int_equal(found.rows, expected.rows);
    assert_int_equal(found.cols, expected.cols);
    assert_int_equal(cv::norm(found, expected, cv::NORM_INF), 0);
}

static void a_jpeg_is_turned_as_its_exif_says_and_as_opencv_does(void **)
{
    const Bytes jpeg = encoded(".jpg");
    assert_same(decoded_bgr(image_of(jpeg, VDNA_PIXEL_MJPG)), cv::imdecode(jpeg, cv::IMREAD_COLOR));
    for (uint8_t orientation = 1; orientation <= 8; orientation++)
        for (const bool little : {false, true}) {
            const Bytes bytes = jpeg_with_exif(jpeg, exif_block(orientation, little));
            const cv::Mat expected = cv::imdecode(bytes, cv::IMREAD_COLOR);
            assert_int_equal(expected.cols, orientation < 5 ? width : height);
            assert_same(decoded_bgr(image_of(bytes, VDNA_PIXEL_MJPG)), expected);
            assert_same(decoded_bgr(image_of(bytes, VDNA_PIXEL_ENCODED)), expected);
        }
}

// The kinds of JPEG that differ in how they are decoded.
struct Kind {
    const char *name;
    int channels;
    int columns, rows; // that share a sample of chroma
    bool progressive;
};
static const Kind kinds[] = {{"4:2:0", 3, 2, 2, false},
                             {"4:2:2", 3, 2, 1, false},
                             {"4:4:4", 3, 1, 1, false},
                             {"grey", 1, 1, 1, false},
                             {"progressive", 3, 2, 2, true}};

// Blurred noise.
static Bytes jpeg_of(const Kind &kind, int columns, int rows)
{
    Bytes pixels = noise(static_cast<size_t>(columns * rows * kind.channels));
    cv::Mat picture(rows, columns, CV_8UC(kind.channels), pixels.data());
    cv::blur(picture, picture, {3, 3});

    jpeg_compress_struct jpeg{};
    jpeg_error_mgr errors;
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    unsigned char *data = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&jpeg, &data, &size);
    jpeg.image_width = static_cast<JDIMENSION>(columns);
    jpeg.image_height = static_cast<JDIMENSION>(rows);
    jpeg.input_components = kind.channels;
    jpeg.in_color_space = kind.channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_set_defaults(&jpeg);
    jpeg.comp_info[0].h_samp_factor = kind.columns;
    jpeg.comp_info[0].v_samp_factor = kind.rows;
    if (kind.progressive)
        jpeg_simple_progression(&jpeg);
    jpeg_start_compress(&jpeg, TRUE);
    for (int y = 0; y < rows; y++) {
        JSAMPROW row = picture.ptr(y);
        jpeg_write_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    Bytes bytes(data, data + size);
    std::free(data);
    return bytes;
}

// The size that a JPEG of `stored` pixels is decoded at.
static picture::Size reduced_size(picture::Size stored, picture::Size least, uint8_t orientation)
{
    const Bytes jpeg = jpeg_with_exif(
        jpeg_of(kinds[0], static_cast<int>(stored.width), static_cast<int>(stored.height)),
        exif_block(orientation));
    Decoder decoder(stored.width * stored.height);
    const vdna_pixels pixels =
        decoder.decode({jpeg.data(), jpeg.size(), 0, 0, 0, VDNA_PIXEL_MJPG}, least);
    return picture::size_of(pixels);
}

static void a_reduced_jpeg_is_the_smallest_that_is_no_smaller_than_asked(void **)
{
    struct Case {
        picture::Size stored, least, expected;
        uint8_t orientation;
    };
    const Case cases[] = {
        {{640, 480}, {224, 224}, {320, 240}, 1}, {{640, 480}, {320, 240}, {320, 240}, 1},
        {{640, 480}, {321, 240}, {640, 480}, 1}, {{640, 480}, {320, 241}, {640, 480}, 1},
        {{640, 480}, {160, 120}, {160, 120}, 1}, {{640, 480}, {80, 60}, {80, 60}, 1},
        {{640, 480}, {1, 1}, {80, 60}, 1}, // an eighth is the least there is
        {{640, 480}, {0, 0}, {80, 60}, 1},       {{320, 240}, {224, 224}, {320, 240}, 1},
        {{100, 80}, {224, 224}, {100, 80}, 1},   {{61, 45}, {31, 23}, {31, 23}, 1}, // rounded up
        {{61, 45}, {8, 6}, {8, 6}, 1},           {{3, 1}, {1, 1}, {1, 1}, 1},
        {{64, 32}, {16, 32}, {16, 32}, 6}, // turned before it is compared
    };
    for (const Case &c : cases) {
        const picture::Size found = reduced_size(c.stored, c.least, c.orientation);
        if (found != c.expected)
            fail_msg("%ux%u for %ux%u, turned as %d: decoded at %ux%u, expected %ux%u",
                     c.stored.width, c.stored.height, c.least.width, c.least.height, c.orientation,
                     found.width, found.height, c.expected.width, c.expected.height);
    }
}

static void a_reduced_jpeg_is_turned_and_has_the_bits_of_opencvs(void **)
{
    struct Reduction {
        uint32_t divisor;
        int flag;
    };
    const Reduction reductions[] = {
        {2, cv::IMREAD_REDUCED_COLOR_2},
        {4, cv::IMREAD_REDUCED_COLOR_4},
        {8, cv::IMREAD_REDUCED_COLOR_8},
    };
    constexpr uint32_t columns = 104, rows = 72;
    for (const Kind &kind : kinds)
        for (const Reduction &reduction : reductions)
            for (uint8_t orientation = 1; orientation <= 8; orientation++) {
                const Bytes jpeg =
                    jpeg_with_exif(jpeg_of(kind, columns, rows), exif_block(orientation));
                const cv::Mat expected = cv::imdecode(jpeg, reduction.flag);
                Decoder decoder(columns * rows);
                const picture::Size least = {static_cast<uint32_t>(expected.cols),
                                             static_cast<uint32_t>(expected.rows)};
                assert_int_equal(least.width * least.height * reduction.divisor * reduction.divisor,
                                 columns * rows);
                const vdna_pixels found =
                    decoder.decode({jpeg.data(), jpeg.size(), 0, 0, 0, VDNA_PIXEL_MJPG}, least);
                assert_true(picture::size_of(found) == least);
                for (int y = 0; y < expected.rows; y++)
                    if (std::memcmp(found.data + static_cast<size_t>(y) * found.stride,
                                    expected.ptr(y), size_t{3} * least.width) != 0)
                        fail_msg("%s, a %uth, turned as %d: row %d is not what OpenCV gives",
                                 kind.name, reduction.divisor, orientation, y);
            }
}

static void what_is_refused_in_full_is_refused_reduced(void **)
{
    const Bytes whole = jpeg_of(kinds[0], 104, 72);
    const auto refused = [](const Bytes &jpeg, vdna_status status, uint32_t max_pixels) {
        Decoder decoder(max_pixels);
        try {
            decoder.decode({jpeg.data(), jpeg.size(), 0, 0, 0, VDNA_PIXEL_MJPG}, {1, 1});
        } catch (const vdna::fail::Failure &failure) {
            return failure.status() == status;
        }
        return false;
    };
    assert_false(refused(whole, VDNA_ERR_FORMAT, 104 * 72));
    // The limit is that of the picture as it is stored.
    assert_true(refused(whole, VDNA_ERR_UNSUPPORTED, 104 * 72 - 1));
    for (const size_t size : {whole.size() / 2, whole.size() - 40, whole.size() - 2})
        assert_true(refused(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)),
                            VDNA_ERR_FORMAT, 104 * 72));
}

static void raw_pictures_are_never_reduced(void **)
{
    for (const Trial &trial : trials) {
        const Bytes bytes = trial.make_bytes(0);
        Decoder decoder(width * height);
        const vdna_pixels pixels = decoder.decode(image_of(bytes, trial.fourcc), {1, 1});
        assert_int_equal(pixels.width, width);
        assert_int_equal(pixels.height, height);
    }
}

static void a_damaged_exif_block_leaves_a_jpeg_as_it_is(void **)
{
    const Bytes jpeg = encoded(".jpg");
    const cv::Mat stored = decoded_bgr(image_of(jpeg, VDNA_PIXEL_MJPG));
    Bytes far = exif_block(6);
    far[4] = 0xFF; // its directory begins behind the end
    for (const Bytes &block : {Bytes{}, Bytes{'M', 'M'}, far, exif_block(9)})
        assert_same(decoded_bgr(image_of(jpeg_with_exif(jpeg, block), VDNA_PIXEL_MJPG)), stored);
}

static void a_jpeg_in_cmyk_is_refused_by_name(void **)
{
    // Header and the begin of a scan, of four components.
    const Bytes cmyk = {0xFF, 0xD8, 0xFF, 0xC0, 0, 20,   8, 0, 24,   0, 32,   4,    1, 0x11,
                        0,    2,    0x11, 0,    3, 0x11, 0, 4, 0x11, 0, 0xFF, 0xDA, 0, 14,
                        4,    1,    0,    2,    0, 3,    0, 4, 0,    0, 63,   0};
    const std::string reason = refusal(image_of(cmyk, VDNA_PIXEL_MJPG), VDNA_ERR_UNSUPPORTED);
    assert_true(reason.find("CMYK") != std::string::npos);
}

// A picture of words, the low byte first, in rows of `columns`.
static Bytes words_of(const std::vector<uint32_t> &values, size_t columns, size_t padding = 0)
{
    Bytes bytes;
    for (size_t i = 0; i < values.size(); i++) {
        bytes.push_back(static_cast<uint8_t>(values[i]));
        bytes.push_back(static_cast<uint8_t>(values[i] >> 8));
        if ((i + 1) % columns == 0)
            bytes.insert(bytes.end(), padding, 0xEE);
    }
    return bytes;
}

struct Depth {
    uint32_t fourcc, bits;
};
static const Depth depths[] = {{VDNA_PIXEL_Y10, 10},
                               {VDNA_PIXEL_Y12, 12},
                               {VDNA_PIXEL_Y14, 14},
                               {VDNA_PIXEL_Y16, 16},
                               {VDNA_PIXEL_LG16, 16}};

static void grey_of_10_to_16_bits_is_scaled_by_its_bits(void **)
{
    for (const Depth &depth : depths) {
        const uint32_t white = (1u << depth.bits) - 1, columns = 256, rows = (white + 1) / columns;
        std::vector<uint32_t> values;
        for (uint32_t value = 0; value <= white; value++)
            values.push_back(value);
        const Bytes packed = words_of(values, columns), padded = words_of(values, columns, 6);
        for (const Bytes &bytes : {packed, padded}) {
            Decoder decoder(columns * rows);
            const vdna_pixels pixels =
                decoder.decode({bytes.data(), bytes.size(), columns, rows,
                                static_cast<uint32_t>(bytes.size() / rows), depth.fourcc});
            assert_int_equal(pixels.channels, 1);
            for (uint32_t value = 0; value <= white; value++)
                assert_int_equal(pixels.data[value / columns * pixels.stride + value % columns],
                                 std::lround(value * 255.0 / white));
        }
    }
}

static void a_value_of_more_bits_than_its_format_has_is_refused(void **)
{
    for (const Depth &depth : depths) {
        if (depth.bits == 16)
            continue;
        const Bytes bytes = words_of({0, 1u << depth.bits}, 2);
        const std::string reason =
            refusal({bytes.data(), bytes.size(), 2, 1, 0, depth.fourcc}, VDNA_ERR_FORMAT);
        assert_true(reason.find("more than " + std::to_string(depth.bits) + " bits") !=
                    std::string::npos);
    }
}

static void grey_that_names_16_bits_and_uses_fewer_is_refused(void **)
{
    for (const uint32_t fourcc : {VDNA_PIXEL_Y16, VDNA_PIXEL_LG16}) {
        const Bytes twelve = words_of({0, 4095}, 2), all = words_of({0, 16384}, 2);
        const std::string reason =
            refusal({twelve.data(), twelve.size(), 2, 1, 0, fourcc}, VDNA_ERR_UNSUPPORTED);
        assert_true(reason.find("no value uses more than 12") != std::string::npos);
        Decoder decoder;
        decoder.decode({all.data(), all.size(), 2, 1, 0, fourcc});
    }
}

static void pixels_of_two_bytes_under_the_name_of_one_are_refused(void **)
{
    struct Case {
        uint32_t pixelformat, columns, rows, stride;
        size_t bytes;
    };
    const Case wide[] = {
        {VDNA_PIXEL_GREY, 160, 120, 320, 320 * 120},   // its stride says so
        {VDNA_PIXEL_GREY, 160, 120, 160, 320 * 120},   // only its size does
        {VDNA_PIXEL_GREY, 160, 120, 0, 320 * 120},     // as above
        {VDNA_PIXEL_GREY, 752, 480, 1536, 1536 * 480}, // rows aligned to 64 bytes
        {VDNA_PIXEL_GREY, 256, 2, 512, 1024},          {VDNA_PIXEL_RGB3, 160, 120, 960, 960 * 120},
        {VDNA_PIXEL_BGR4, 100, 10, 800, 8000},
    };
    for (const Case &c : wide) {
        const Bytes bytes(c.bytes, 1);
        const std::string reason =
            refusal({bytes.data(), bytes.size(), c.columns, c.rows, c.stride, c.pixelformat},
                    VDNA_ERR_FORMAT);
        assert_true(reason.find("two bytes a channel?") != std::string::npos);
    }
    const Case padded[] = {
        {VDNA_PIXEL_GREY, 160, 120, 192, 192 * 120},       // rows aligned to 64 bytes
        {VDNA_PIXEL_GREY, 160, 120, 512, 512 * 120},       // and to 512
        {VDNA_PIXEL_GREY, 160, 120, 320, 320 * 119 + 160}, // the left half of a larger picture
        {VDNA_PIXEL_GREY, 160, 120, 1280, 1280 * 120},     // a part of a larger picture
        {VDNA_PIXEL_GREY, 160, 120, 160, 160 * 120 + 99},  // bytes behind the picture
        {VDNA_PIXEL_RGB3, 160, 120, 512, 512 * 120},       {VDNA_PIXEL_GREY, 1, 3, 4, 12},
    };
    for (const Case &c : padded) {
        const Bytes bytes(c.bytes, 1);
        Decoder decoder(c.columns * c.rows);
        decoder.decode({bytes.data(), bytes.size(), c.columns, c.rows, c.stride, c.pixelformat});
    }
}

static void raw_pictures_need_every_byte_and_no_more(void **)
{
    struct Case {
        uint32_t pixelformat;
        uint32_t stride;
        size_t bytes; // least number for 32x24
    };
    const Case cases[] = {
        {VDNA_PIXEL_GREY, 0, 768},          {VDNA_PIXEL_GREY, 40, 40 * 23 + 32},
        {VDNA_PIXEL_RGB3, 0, 2304},         {VDNA_PIXEL_BGR4, 130, 130 * 23 + 128},
        {VDNA_PIXEL_YUYV, 0, 1536},         {VDNA_PIXEL_UYVY, 70, 70 * 23 + 64},
        {VDNA_PIXEL_I420, 0, 1152},         {VDNA_PIXEL_I420, 40, 40 * 36},
        {VDNA_PIXEL_NV12, 34, 34 * 36},     {VDNA_PIXEL_Y16, 0, 1536},
        {VDNA_PIXEL_Y12, 70, 70 * 23 + 64},
    };
    for (const Case &c : cases) {
        // On the heap, so that a sanitizer sees a byte read past the end.
        const Bytes bytes(c.bytes, 0); // black at any depth
        Decoder decoder;
        decoder.decode(image_of(bytes, c.pixelformat, c.stride));
        vdna_image short_of_one = image_of(bytes, c.pixelformat, c.stride);
        short_of_one.size--;
        const std::string reason = refusal(short_of_one, VDNA_ERR_FORMAT);
        assert_true(reason.find("expected at least " + std::to_string(c.bytes) + " bytes") !=
                    std::string::npos);
    }
}

static void impossible_sides_and_strides_are_refused(void **)
{
    const Bytes bytes(10000, 128);
    const uint8_t *data = bytes.data();
    const size_t size = bytes.size();
    refusal({data, size, 0, 24, 0, VDNA_PIXEL_GREY}, VDNA_ERR_FORMAT);
    refusal({data, size, 32, 0, 0, VDNA_PIXEL_NV12}, VDNA_ERR_FORMAT);
    refusal({data, size, 32, 24, 31, VDNA_PIXEL_GREY}, VDNA_ERR_FORMAT);
    refusal({data, size, 32, 24, 95, VDNA_PIXEL_RGB3}, VDNA_ERR_FORMAT);
    refusal({data, size, 32, 24, UINT32_MAX, VDNA_PIXEL_RGB3}, VDNA_ERR_FORMAT);
    refusal({data, size, 31, 24, 0, VDNA_PIXEL_YUYV}, VDNA_ERR_FORMAT);
    refusal({data, size, 31, 24, 32, VDNA_PIXEL_I420}, VDNA_ERR_FORMAT);
    refusal({data, size, 32, 23, 0, VDNA_PIXEL_I420}, VDNA_ERR_FORMAT);
    refusal({data, size, 32, 24, 33, VDNA_PIXEL_NV12}, VDNA_ERR_FORMAT);
    refusal({data, size, 16385, 1, 0, VDNA_PIXEL_GREY}, VDNA_ERR_UNSUPPORTED);
    refusal({data, size, UINT32_MAX, UINT32_MAX, 0, VDNA_PIXEL_BGR4}, VDNA_ERR_UNSUPPORTED);
    refusal({data, size, 16384, 16384, 0, VDNA_PIXEL_GREY}, VDNA_ERR_UNSUPPORTED);
    refusal({nullptr, size, 32, 24, 0, VDNA_PIXEL_GREY}, VDNA_ERR_FORMAT);
    assert_true(
        refusal({data, size, 32, 24, 0, VDNA_FOURCC('Y', 'V', '1', 2)}, VDNA_ERR_UNSUPPORTED)
            .find("'YV1?'") != std::string::npos);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(every_colour_format_is_tried),
        cmocka_unit_test(every_colour_format_gives_the_picture_with_and_without_padding),
        cmocka_unit_test(yuv_is_converted_as_opencv_does_to_the_last_bit),
        cmocka_unit_test(every_colour_is_converted_as_opencv_does),
        cmocka_unit_test(colours_are_those_of_the_textbook),
        cmocka_unit_test(the_mean_grey_level_has_the_bits_of_opencvs_mean),
        cmocka_unit_test(a_jpeg_gives_the_picture_with_and_without_the_name_of_its_format),
        cmocka_unit_test(an_encoded_picture_that_is_no_jpeg_is_refused_with_what_to_do),
        cmocka_unit_test(grey_pictures_have_three_equal_channels),
        cmocka_unit_test(mean_grey_weighs_the_channels_over_the_whole_picture),
        cmocka_unit_test(no_picture_costs_an_allocation),
        cmocka_unit_test(mjpg_frames_may_lack_their_huffman_tables),
        cmocka_unit_test(mjpg_frames_may_be_padded_before_and_after_the_end_marker),
        cmocka_unit_test(damaged_jpeg_is_refused),
        cmocka_unit_test(a_jpeg_that_claims_a_huge_picture_is_refused_unread),
        cmocka_unit_test(a_jpeg_is_turned_as_its_exif_says_and_as_opencv_does),
        cmocka_unit_test(a_damaged_exif_block_leaves_a_jpeg_as_it_is),
        cmocka_unit_test(a_reduced_jpeg_is_the_smallest_that_is_no_smaller_than_asked),
        cmocka_unit_test(a_reduced_jpeg_is_turned_and_has_the_bits_of_opencvs),
        cmocka_unit_test(what_is_refused_in_full_is_refused_reduced),
        cmocka_unit_test(raw_pictures_are_never_reduced),
        cmocka_unit_test(a_jpeg_in_cmyk_is_refused_by_name),
        cmocka_unit_test(grey_of_10_to_16_bits_is_scaled_by_its_bits),
        cmocka_unit_test(a_value_of_more_bits_than_its_format_has_is_refused),
        cmocka_unit_test(grey_that_names_16_bits_and_uses_fewer_is_refused),
        cmocka_unit_test(pixels_of_two_bytes_under_the_name_of_one_are_refused),
        cmocka_unit_test(raw_pictures_need_every_byte_and_no_more),
        cmocka_unit_test(impossible_sides_and_strides_are_refused),
        cmocka_unit_test(a_picture_of_one_pixel_too_many_is_refused_in_every_format),
    };
    return cmocka_run_group_tests_name("decode", tests, nullptr, nullptr);
}
