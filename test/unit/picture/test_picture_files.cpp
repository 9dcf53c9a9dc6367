// Picture files: each kind gives the picture in a camera's format, and bytes that are no picture
// are refused.
#include <cstring>
#include <string>
#include <vector>

#include <cmocka.hpp>
#include <opencv2/imgcodecs.hpp>

#include "failure.hpp"
#include "picture/decode.hpp"
#include "picture/files/file_converter.hpp"

using namespace vdna;
using picture::FileConverter;

using Bytes = std::vector<uint8_t>;

static const int width = 32, height = 24;

template <class Level>
static cv::Mat noise(int type)
{
    cv::Mat pixels(height, width, type);
    uint32_t state = 1;
    for (int y = 0; y < height; y++)
        for (int i = 0; i < width * pixels.channels(); i++) {
            state = state * 1664525u + 1013904223u;
            pixels.ptr<Level>(y)[i] = static_cast<Level>(state >> 8);
        }
    return pixels;
}

static const cv::Mat bgr = noise<uint8_t>(CV_8UC3);

static Bytes encoded(const char *extension, const cv::Mat &pixels = bgr)
{
    Bytes bytes;
    assert_true(cv::imencode(extension, pixels, bytes));
    return bytes;
}

// A file, converted and then decoded.
static cv::Mat decoded(const Bytes &bytes)
{
    FileConverter converter;
    picture::Decoder decoder;
    const vdna_pixels pixels = decoder.decode(converter.convert(bytes.data(), bytes.size()));
    assert_int_equal(pixels.channels, 3);
    for (uint32_t c = 0; c < 3; c++)
        assert_int_equal(pixels.rgb[c], 2 - c);
    return cv::Mat(static_cast<int>(pixels.height), static_cast<int>(pixels.width), CV_8UC3,
                   const_cast<uint8_t *>(pixels.data), pixels.stride)
        .clone();
}

static void assert_pixels(const cv::Mat &found, const cv::Mat &expected)
{
    assert_int_equal(found.rows, expected.rows);
    assert_int_equal(found.cols, expected.cols);
    for (int y = 0; y < found.rows; y++)
        assert_memory_equal(found.ptr(y), expected.ptr(y), 3 * static_cast<size_t>(found.cols));
}

// The reason why the file is refused; the status must be `status`.
static std::string refusal(const Bytes &bytes, vdna_status status)
{
    FileConverter converter;
    try {
        converter.convert(bytes.data(), bytes.size());
    } catch (const vdna::fail::Failure &failure) {
        assert_int_equal(failure.status(), status);
        return failure.what();
    }
    fail_msg("a file of %zu bytes was converted", bytes.size());
    return "";
}

static void files_without_loss_give_exactly_the_picture(void **)
{
    for (const char *extension : {".png", ".bmp", ".ppm", ".tiff"})
        assert_pixels(decoded(encoded(extension)), bgr);
}

static void a_jpeg_file_goes_through_as_it_is(void **)
{
    const Bytes bytes = encoded(".jpg");
    FileConverter converter;
    const vdna_image image = converter.convert(bytes.data(), bytes.size());
    assert_ptr_equal(image.data, bytes.data());
    assert_int_equal(image.size, bytes.size());
    assert_int_equal(image.pixelformat, VDNA_PIXEL_MJPG);
}

static void a_webp_file_gives_what_its_library_makes_of_it(void **)
{
    const Bytes bytes = encoded(".webp");
    assert_pixels(decoded(bytes), cv::imdecode(bytes, cv::IMREAD_COLOR));
}

static void grey_becomes_colour(void **)
{
    const cv::Mat grey = noise<uint8_t>(CV_8UC1);
    cv::Mat expected;
    cv::merge(std::vector<cv::Mat>(3, grey), expected);
    for (const char *extension : {".png", ".pgm", ".tiff"})
        assert_pixels(decoded(encoded(extension, grey)), expected);
}

static void transparency_is_dropped(void **)
{
    std::vector<cv::Mat> planes;
    cv::split(bgr, planes);
    planes.push_back(noise<uint8_t>(CV_8UC1));
    cv::Mat transparent;
    cv::merge(planes, transparent);
    assert_pixels(decoded(encoded(".png", transparent)), bgr);
}

static void sixteen_bits_keep_their_upper_eight(void **)
{
    const cv::Mat deep = noise<uint16_t>(CV_16UC3);
    cv::Mat expected(height, width, CV_8UC3);
    for (int y = 0; y < height; y++)
        for (int i = 0; i < 3 * width; i++)
            expected.ptr(y)[i] = static_cast<uint8_t>(deep.ptr<uint16_t>(y)[i] >> 8);
    for (const char *extension : {".png", ".ppm"})
        assert_pixels(decoded(encoded(extension, deep)), expected);
    // libtiff divides by 257.
    const cv::Mat tiff = decoded(encoded(".tiff", deep));
    for (int y = 0; y < height; y++)
        for (int i = 0; i < 3 * width; i++)
            assert_in_range(tiff.ptr(y)[i], (deep.ptr<uint16_t>(y)[i] + 128) / 257,
                            (deep.ptr<uint16_t>(y)[i] + 128) / 257);
}

// EXIF that says "turn by 90 degrees", as a TIFF file within any container.
static const std::string turned("MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0",
                                26);

static void append_be32(Bytes &bytes, uint32_t number)
{
    for (int shift = 24; shift >= 0; shift -= 8)
        bytes.push_back(static_cast<uint8_t>(number >> shift));
}

static uint32_t crc32(const Bytes &bytes)
{
    uint32_t crc = UINT32_MAX;
    for (const uint8_t byte : bytes) {
        crc ^= byte;
        for (int bit = 0; bit < 8; bit++)
            crc = crc & 1 ? crc >> 1 ^ 0xEDB88320 : crc >> 1;
    }
    return ~crc;
}

static void an_orientation_in_exif_is_not_applied(void **)
{
    // PNG: a chunk eXIf after the header, which ends at byte 33.
    Bytes named = {'e', 'X', 'I', 'f'}, chunk;
    named.insert(named.end(), turned.begin(), turned.end());
    append_be32(chunk, static_cast<uint32_t>(turned.size()));
    chunk.insert(chunk.end(), named.begin(), named.end());
    append_be32(chunk, crc32(named));
    Bytes png = encoded(".png");
    png.insert(png.begin() + 33, chunk.begin(), chunk.end());
    assert_pixels(decoded(png), bgr);
    // OpenCV would have turned it, so the orientation in the file is effective.
    assert_int_equal(cv::imdecode(png, cv::IMREAD_COLOR).rows, width);

    // JPEG: a segment APP1 after the first marker.
    const Bytes jpeg = encoded(".jpg");
    Bytes with_exif = jpeg;
    const std::string head("\xff\xe1\0\x22"
                           "Exif\0\0",
                           10);
    with_exif.insert(with_exif.begin() + 2, turned.begin(), turned.end());
    with_exif.insert(with_exif.begin() + 2, head.begin(), head.end());
    assert_int_equal(cv::imdecode(with_exif, cv::IMREAD_COLOR).rows, width);
    assert_pixels(decoded(with_exif), decoded(jpeg));
}

static void files_cut_short_are_refused(void **)
{
    for (const char *extension : {".png", ".webp", ".bmp", ".ppm", ".tiff"}) {
        Bytes bytes = encoded(extension);
        bytes.resize(bytes.size() / 2);
        refusal(bytes, VDNA_ERR_FORMAT);
        bytes.resize(13);
        refusal(bytes, VDNA_ERR_FORMAT);
    }
}

static void other_files_than_pictures_are_refused(void **)
{
    for (const char *text : {"GIF89a", "P7\n", "NITF02.10", "#?RADIANCE\n", "text"})
        refusal(Bytes(text, text + std::strlen(text)), VDNA_ERR_UNSUPPORTED);
    refusal({}, VDNA_ERR_FORMAT);
}

static void a_small_file_that_claims_a_huge_picture_is_refused_unread(void **)
{
    Bytes png = encoded(".png"); // IHDR: 32-bit width at 16, height at 20
    for (const size_t at : {size_t{18}, size_t{22}}) {
        png[at] = 60000 >> 8;
        png[at + 1] = 60000 & 255;
    }
    assert_true(refusal(png, VDNA_ERR_UNSUPPORTED).find("60000x60000") != std::string::npos);

    const std::string pnm = "P6\n# much\n60000 60000\n255\n";
    refusal(Bytes(pnm.begin(), pnm.end()), VDNA_ERR_UNSUPPORTED);
    Bytes bmp = encoded(".bmp"); // 32-bit little-endian width at 18
    bmp[20] = 1;
    refusal(bmp, VDNA_ERR_UNSUPPORTED);
    const char webp[] = "RIFF\x16\0\0\0WEBPVP8X\x0a\0\0\0\0\0\0\0\xff\xff\0\xff\xff\0";
    refusal(Bytes(webp, webp + sizeof webp), VDNA_ERR_UNSUPPORTED);
    const char tiff[] = "MM\0*\0\0\0\x08\0\x01\x01\x42\0\x04\0\0\0\x01\0\x10\0\0";
    refusal(Bytes(tiff, tiff + sizeof tiff), VDNA_ERR_UNSUPPORTED);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(files_without_loss_give_exactly_the_picture),
        cmocka_unit_test(a_jpeg_file_goes_through_as_it_is),
        cmocka_unit_test(a_webp_file_gives_what_its_library_makes_of_it),
        cmocka_unit_test(grey_becomes_colour),
        cmocka_unit_test(transparency_is_dropped),
        cmocka_unit_test(sixteen_bits_keep_their_upper_eight),
        cmocka_unit_test(an_orientation_in_exif_is_not_applied),
        cmocka_unit_test(files_cut_short_are_refused),
        cmocka_unit_test(other_files_than_pictures_are_refused),
        cmocka_unit_test(a_small_file_that_claims_a_huge_picture_is_refused_unread),
    };
    return cmocka_run_group_tests_name("picture files", tests, nullptr, nullptr);
}
