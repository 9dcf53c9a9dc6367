// Decoding: every pixel format gives the picture, and bytes that are none are refused.
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include <cmocka.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "decode.hpp"
#include "failure.hpp"

using namespace vdna::backbone;

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

static Bytes encoded(const char *extension)
{
    Bytes bytes;
    assert_true(cv::imencode(extension, bgr_picture(), bytes));
    return bytes;
}

// No channel of no pixel is further than `tolerance` from the picture.
static void assert_is_the_picture(const vdna_image &image, int tolerance)
{
    Decoder decoder;
    const Picture picture = decoder.decode(image);
    assert_int_equal(picture.pixels.rows, height);
    assert_int_equal(picture.pixels.cols, width);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            for (int c = 0; c < 3; c++) {
                const uint8_t *pixel = picture.pixels.ptr(y) + x * picture.pixels.channels();
                assert_in_range(pixel[picture.rgb[static_cast<size_t>(c)]] + 64 - rgb_at(x, y)[c],
                                64 - tolerance, 64 + tolerance);
            }
}

// The reason why `image` is refused; the status must be `status`.
static std::string refusal(const vdna_image &image, vdna_status status,
                           uint32_t max_pixels = VDNA_IMAGE_PIXELS_MAX)
{
    Decoder decoder(max_pixels);
    try {
        decoder.decode(image);
    } catch (const Failure &failure) {
        assert_int_equal(failure.status(), status);
        return failure.what();
    }
    fail_msg("%ux%u, stride %u, %zu bytes: was decoded", image.width, image.height,
             image.row_stride, image.size);
    return "";
}

static void rgb_formats_give_exactly_the_picture(void **)
{
    for (const int padding : {0, 5}) {
        const auto stride = [&](int channels) {
            return static_cast<uint32_t>(padding ? channels * width + padding : 0);
        };
        const Bytes rgb3 = packed(3, false, padding), bgr3 = packed(3, true, padding);
        const Bytes rgb4 = packed(4, false, padding), bgr4 = packed(4, true, padding);
        assert_is_the_picture(image_of(rgb3, VDNA_PIXEL_RGB3, stride(3)), 0);
        assert_is_the_picture(image_of(bgr3, VDNA_PIXEL_BGR3, stride(3)), 0);
        assert_is_the_picture(image_of(rgb4, VDNA_PIXEL_RGB4, stride(4)), 0);
        assert_is_the_picture(image_of(bgr4, VDNA_PIXEL_BGR4, stride(4)), 0);
    }
}

static void yuv_formats_give_the_picture_with_and_without_padding(void **)
{
    // Rounding to YUV and back costs 2 levels; chroma of the neighbour up to 4 * 1.6 more.
    for (const int padding : {0, 2, 6}) {
        const auto stride = [&](int row) { return static_cast<uint32_t>(padding ? row : 0); };
        const Bytes yuyv = yuv422(false, padding), uyvy = yuv422(true, padding);
        assert_is_the_picture(image_of(yuyv, VDNA_PIXEL_YUYV, stride(2 * width + padding)), 6);
        assert_is_the_picture(image_of(uyvy, VDNA_PIXEL_UYVY, stride(2 * width + padding)), 6);
        const Bytes planes = i420(padding), halves = nv12(padding);
        assert_is_the_picture(image_of(planes, VDNA_PIXEL_I420, stride(width + padding)), 9);
        assert_is_the_picture(image_of(planes, VDNA_PIXEL_YU12, stride(width + padding)), 9);
        assert_is_the_picture(image_of(halves, VDNA_PIXEL_NV12, stride(width + padding)), 9);
    }
}

static void encoded_pictures_give_the_picture(void **)
{
    for (const char *extension : {".png", ".bmp", ".ppm", ".tiff"})
        assert_is_the_picture(image_of(encoded(extension), VDNA_PIXEL_ENCODED), 0);
    assert_is_the_picture(image_of(encoded(".webp"), VDNA_PIXEL_ENCODED), 12);
    assert_is_the_picture(image_of(encoded(".jpg"), VDNA_PIXEL_ENCODED), 12);
    assert_is_the_picture(image_of(encoded(".jpg"), VDNA_PIXEL_MJPG), 12);
}

static void a_picture_of_one_pixel_too_many_is_refused_in_every_format(void **)
{
    constexpr uint32_t pixels = width * height;
    const Bytes jpeg = encoded(".jpg"), raw(size_t{4} * pixels, 128);
    std::vector<vdna_image> images = {image_of(jpeg, VDNA_PIXEL_MJPG)};
    for (const uint32_t format : {VDNA_PIXEL_GREY, VDNA_PIXEL_RGB3, VDNA_PIXEL_BGR4,
                                  VDNA_PIXEL_YUYV, VDNA_PIXEL_I420, VDNA_PIXEL_NV12})
        images.push_back(image_of(raw, format));
    for (const vdna_image &image : images) {
        Decoder decoder(pixels);
        assert_int_equal(decoder.decode(image).pixels.total(), pixels);
        const std::string reason = refusal(image, VDNA_ERR_UNSUPPORTED, pixels - 1);
        assert_true(reason.find(std::to_string(pixels - 1)) != std::string::npos);
    }
    // Padding is converted along with the picture, and takes memory as it does.
    refusal(image_of(raw, VDNA_PIXEL_I420, width + 2), VDNA_ERR_UNSUPPORTED, pixels);
}

static void grey_pictures_have_three_equal_channels(void **)
{
    const Bytes bytes(static_cast<size_t>(width * height), 77);
    Decoder decoder;
    const Picture picture = decoder.decode(image_of(bytes, VDNA_PIXEL_GREY));
    assert_int_equal(picture.pixels.channels(), 1);
    assert_true(picture.rgb == (std::array<int, 3>{0, 0, 0}));
    assert_float_equal(mean_grey(picture), 77.0f, 1e-4f);
}

static void mean_grey_weighs_the_channels_over_the_whole_picture(void **)
{
    // One black and one coloured row: half of 0.299 * 100 + 0.587 * 200 + 0.114 * 50 = 153.
    const Bytes bytes = {0, 0, 0, 0xEE, 100, 200, 50};
    const vdna_image image = {bytes.data(), bytes.size(), 1, 2, 4, VDNA_PIXEL_RGB3};
    Decoder decoder;
    assert_float_equal(mean_grey(decoder.decode(image)), 76.5f, 1e-4f);
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

    // A hole in the middle, as a lost piece of a message leaves it.
    Bytes hole = whole;
    const auto middle = hole.end() - 200;
    hole.erase(middle, middle + 100);
    refusal(image_of(hole, VDNA_PIXEL_MJPG), VDNA_ERR_FORMAT);
}

static void other_files_cut_short_are_refused(void **)
{
    for (const char *extension : {".png", ".webp", ".bmp", ".ppm", ".tiff"}) {
        Bytes bytes = encoded(extension);
        bytes.resize(bytes.size() / 2);
        refusal(image_of(bytes, VDNA_PIXEL_ENCODED), VDNA_ERR_FORMAT);
        bytes.resize(13);
        refusal(image_of(bytes, VDNA_PIXEL_ENCODED), VDNA_ERR_FORMAT);
    }
}

static void other_files_than_pictures_are_refused(void **)
{
    for (const char *text : {"GIF89a", "P7\n", "NITF02.10", "#?RADIANCE\n", "text"})
        refusal(image_of(Bytes(text, text + std::strlen(text)), VDNA_PIXEL_ENCODED),
                VDNA_ERR_UNSUPPORTED);
    refusal(image_of(encoded(".png"), VDNA_PIXEL_MJPG), VDNA_ERR_FORMAT);
    refusal(image_of({}, VDNA_PIXEL_ENCODED), VDNA_ERR_FORMAT);
}

static void put_be16(Bytes &bytes, size_t at, int value)
{
    bytes[at] = static_cast<uint8_t>(value >> 8);
    bytes[at + 1] = static_cast<uint8_t>(value);
}

static void a_small_file_that_claims_a_huge_picture_is_refused_unread(void **)
{
    Bytes png = encoded(".png"); // IHDR: 32-bit width at 16, height at 20
    put_be16(png, 18, 60000);
    put_be16(png, 22, 60000);
    assert_true(
        refusal(image_of(png, VDNA_PIXEL_ENCODED), VDNA_ERR_UNSUPPORTED).find("60000x60000") !=
        std::string::npos);

    Bytes jpeg = encoded(".jpg");
    size_t frame = 2; // SOF0: 16-bit height at 5, width at 7
    while (jpeg[frame + 1] != 0xC0)
        frame += 2u + jpeg[frame + 2] * 256u + jpeg[frame + 3];
    put_be16(jpeg, frame + 5, 60000);
    refusal(image_of(jpeg, VDNA_PIXEL_MJPG), VDNA_ERR_UNSUPPORTED);
    // Each side within its limit, both together not.
    put_be16(jpeg, frame + 5, 16384);
    put_be16(jpeg, frame + 7, 16384);
    refusal(image_of(jpeg, VDNA_PIXEL_MJPG), VDNA_ERR_UNSUPPORTED);

    const std::string pnm = "P6\n# much\n60000 60000\n255\n";
    refusal(image_of(Bytes(pnm.begin(), pnm.end()), VDNA_PIXEL_ENCODED), VDNA_ERR_UNSUPPORTED);
    Bytes bmp = encoded(".bmp"); // 32-bit little-endian width at 18
    bmp[20] = 1;
    refusal(image_of(bmp, VDNA_PIXEL_ENCODED), VDNA_ERR_UNSUPPORTED);
    const char webp[] = "RIFF\x16\0\0\0WEBPVP8X\x0a\0\0\0\0\0\0\0\xff\xff\0\xff\xff\0";
    refusal(image_of(Bytes(webp, webp + sizeof webp), VDNA_PIXEL_ENCODED), VDNA_ERR_UNSUPPORTED);
    const char tiff[] = "MM\0*\0\0\0\x08\0\x01\x01\x42\0\x04\0\0\0\x01\0\x10\0\0";
    refusal(image_of(Bytes(tiff, tiff + sizeof tiff), VDNA_PIXEL_ENCODED), VDNA_ERR_UNSUPPORTED);
}

static void an_orientation_in_exif_is_not_applied(void **)
{
    // "Turn by 90 degrees" would swap the sides.
    const char exif[] = "\xff\xe1\0\x22"
                        "Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0";
    Bytes bytes = encoded(".jpg");
    bytes.insert(bytes.begin() + 2, exif, exif + 36);
    assert_is_the_picture(image_of(bytes, VDNA_PIXEL_ENCODED), 12);
}

static void raw_pictures_need_every_byte_and_no_more(void **)
{
    struct Case {
        uint32_t pixelformat;
        uint32_t stride;
        size_t bytes; // least number for 32x24
    };
    const Case cases[] = {
        {VDNA_PIXEL_GREY, 0, 768},      {VDNA_PIXEL_GREY, 40, 40 * 23 + 32},
        {VDNA_PIXEL_RGB3, 0, 2304},     {VDNA_PIXEL_BGR4, 130, 130 * 23 + 128},
        {VDNA_PIXEL_YUYV, 0, 1536},     {VDNA_PIXEL_UYVY, 70, 70 * 23 + 64},
        {VDNA_PIXEL_I420, 0, 1152},     {VDNA_PIXEL_I420, 40, 40 * 36},
        {VDNA_PIXEL_NV12, 34, 34 * 36},
    };
    for (const Case &c : cases) {
        // On the heap, so that a sanitizer sees a byte read past the end.
        const Bytes bytes(c.bytes, 128);
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
        cmocka_unit_test(rgb_formats_give_exactly_the_picture),
        cmocka_unit_test(yuv_formats_give_the_picture_with_and_without_padding),
        cmocka_unit_test(encoded_pictures_give_the_picture),
        cmocka_unit_test(grey_pictures_have_three_equal_channels),
        cmocka_unit_test(mean_grey_weighs_the_channels_over_the_whole_picture),
        cmocka_unit_test(mjpg_frames_may_lack_their_huffman_tables),
        cmocka_unit_test(mjpg_frames_may_be_padded_before_and_after_the_end_marker),
        cmocka_unit_test(damaged_jpeg_is_refused),
        cmocka_unit_test(other_files_cut_short_are_refused),
        cmocka_unit_test(other_files_than_pictures_are_refused),
        cmocka_unit_test(a_small_file_that_claims_a_huge_picture_is_refused_unread),
        cmocka_unit_test(an_orientation_in_exif_is_not_applied),
        cmocka_unit_test(raw_pictures_need_every_byte_and_no_more),
        cmocka_unit_test(impossible_sides_and_strides_are_refused),
        cmocka_unit_test(a_picture_of_one_pixel_too_many_is_refused_in_every_format),
    };
    return cmocka_run_group_tests_name("decode", tests, nullptr, nullptr);
}
