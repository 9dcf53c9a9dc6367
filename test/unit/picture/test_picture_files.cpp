// Picture files: each kind gives the picture in a camera's format, and bytes that are no picture
// are refused.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include <cmocka.hpp>
#include <exif_block.hpp>
#include <opencv2/imgcodecs.hpp>
#include <tiff_tag.hpp>

#include "failure.hpp"
#include "picture/decode.hpp"
#include "picture/files/file_converter.hpp"
#include "picture/files/kind.hpp"

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
    // Of either kind: with colours that are multiplied by it, and not.
    for (const uint16_t kind : std::vector<uint16_t>{0, 1, 2})
        assert_pixels(decoded(tiff_with(encoded(".tiff", transparent), 338, kind)), bgr);
    cv::Mat deep;
    transparent.convertTo(deep, CV_16U, 257);
    for (const char *extension : {".png", ".tiff"})
        assert_pixels(decoded(encoded(extension, deep)), bgr);
}

// The nearest level of 8 bits of each value.
static cv::Mat scaled(const cv::Mat &deep, double white)
{
    cv::Mat expected(deep.rows, deep.cols, CV_8UC3);
    for (int y = 0; y < deep.rows; y++)
        for (int i = 0; i < 3 * deep.cols; i++)
            expected.ptr(y)[i] =
                static_cast<uint8_t>(std::lround(deep.ptr<uint16_t>(y)[i] * 255 / white));
    return expected;
}

static void sixteen_bits_are_scaled_to_the_nearest_of_eight_in_every_kind(void **)
{
    const cv::Mat deep = noise<uint16_t>(CV_16UC3);
    for (const char *extension : {".png", ".ppm", ".tiff"})
        assert_pixels(decoded(encoded(extension, deep)), scaled(deep, 65535));
    std::vector<cv::Mat> planes;
    cv::split(deep, planes);
    cv::Mat grey;
    cv::merge(std::vector<cv::Mat>(3, planes[0]), grey);
    for (const char *extension : {".png", ".pgm", ".tiff"})
        assert_pixels(decoded(encoded(extension, planes[0])), scaled(grey, 65535));
}

static void a_dark_picture_of_an_unknown_depth_is_refused_and_black_is_black(void **)
{
    struct Case {
        uint16_t largest;
        const char *bits;
    };
    for (const Case &c :
         {Case{255, "more than 8 of them"}, Case{1000, "more than 10 of them"},
          Case{4095, "more than 12 of them"}, Case{16383, "more than 14 of them"}}) {
        cv::Mat deep(height, width, CV_16UC1, cv::Scalar(1));
        deep.at<uint16_t>(height - 1, width - 1) = c.largest;
        for (const char *extension : {".png", ".pgm", ".tiff"}) {
            const std::string reason = refusal(encoded(extension, deep), VDNA_ERR_UNSUPPORTED);
            assert_true(reason.find(c.bits) != std::string::npos);
        }
        deep.at<uint16_t>(0, 0) = 16384; // needs more bits than any of these cameras has
        decoded(encoded(".png", deep));
    }
    const cv::Mat black(height, width, CV_16UC1, cv::Scalar(0));
    assert_pixels(decoded(encoded(".png", black)), cv::Mat::zeros(height, width, CV_8UC3));
}

static void pnm_pictures_are_scaled_by_their_white_as_text_and_as_bytes(void **)
{
    struct Case {
        std::string file;
        std::vector<uint8_t> red, blue;
    };
    using namespace std::string_literals;
    const Case cases[] = {
        {"P1\n3 2\n0 1 0\n111\n"s, {255, 0, 255, 0, 0, 0}, {}},
        {"P4 3 2 \x40\xe0"s, {255, 0, 255, 0, 0, 0}, {}},
        {"P4\n9 1\n\x01\x7f"s, {255, 255, 255, 255, 255, 255, 255, 0, 255}, {}},
        {"P2\n# camera\n3 1 # wide\n9\n0 5 9"s, {0, 142, 255}, {}},
        {"P5\n3 1\n9\n\0\x05\x09"s, {0, 142, 255}, {}},
        {"P5\n3 1\n4095\n\0\0\x08\0\x0f\xff"s, {0, 128, 255}, {}},
        {"P2 3 1 4095\n0 2048 4095\n"s, {0, 128, 255}, {}},
        {"P3 2 1 1023 0 1 1023 1023 1 0"s, {0, 255}, {255, 0}},
        {"P6 2 1 255\n\x01\x02\x03\x04\x05\x06"s, {1, 4}, {3, 6}},
    };
    for (const Case &c : cases) {
        const cv::Mat pixels = decoded(Bytes(c.file.begin(), c.file.end()));
        assert_int_equal(pixels.rows * pixels.cols, c.red.size());
        for (size_t i = 0; i < c.red.size(); i++) {
            const int at = static_cast<int>(i);
            const auto pixel = pixels.at<cv::Vec3b>(at / pixels.cols, at % pixels.cols);
            assert_int_equal(pixel[2], c.red[i]);
            assert_int_equal(pixel[0], c.blue.empty() ? c.red[i] : c.blue[i]);
        }
    }
}

static void damaged_pnm_pictures_are_refused(void **)
{
    for (const std::string text :
         {"P2 2 1 9 0", "P2 2 1 9 0 10", "P2 2 1 0 0 0", "P2 2 1 65536 0 0", "P2 2 x 9 0 0",
          "P1 2 1 0 2", "P5 2 1 9\n0", "P2 2 1 9 0 99999999999", "P6 1 1 # 255", "P4 9 1\n1"})
        refusal(Bytes(text.begin(), text.end()), VDNA_ERR_FORMAT);
}

static void append_be32(Bytes &bytes, uint32_t number)
{
    for (int shift = 24; shift >= 0; shift -= 8)
        bytes.push_back(static_cast<uint8_t>(number >> shift));
}

static void append_le(Bytes &bytes, uint32_t number, size_t count)
{
    for (size_t i = 0; i < count; i++)
        bytes.push_back(static_cast<uint8_t>(number >> 8 * i));
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

// With a chunk eXIf after the header, which ends at byte 33, or before the end, of 12 bytes.
static Bytes png_with_exif(Bytes png, const Bytes &block, bool late = false)
{
    Bytes named = {'e', 'X', 'I', 'f'}, chunk;
    named.insert(named.end(), block.begin(), block.end());
    append_be32(chunk, static_cast<uint32_t>(block.size()));
    chunk.insert(chunk.end(), named.begin(), named.end());
    append_be32(chunk, crc32(named));
    png.insert(late ? png.end() - 12 : png.begin() + 33, chunk.begin(), chunk.end());
    return png;
}

// A simple WebP file as one with room for EXIF, after the pixels.
static Bytes webp_with_exif(const Bytes &webp, const Bytes &block)
{
    Bytes body = {'W', 'E', 'B', 'P', 'V', 'P', '8', 'X', 10, 0, 0, 0, 8, 0, 0, 0};
    append_le(body, width - 1, 3);
    append_le(body, height - 1, 3);
    body.insert(body.end(), webp.begin() + 12, webp.end());
    for (const char letter : {'E', 'X', 'I', 'F'})
        body.push_back(static_cast<uint8_t>(letter));
    append_le(body, static_cast<uint32_t>(block.size()), 4);
    body.insert(body.end(), block.begin(), block.end());
    body.resize(body.size() + body.size() % 2);
    Bytes file = {'R', 'I', 'F', 'F'};
    append_le(file, static_cast<uint32_t>(body.size()), 4);
    file.insert(file.end(), body.begin(), body.end());
    return file;
}

// By OpenCV's own means.
static cv::Mat turned(const cv::Mat &stored, int orientation)
{
    constexpr int both = -1, left_right = 1, up_down = 0;
    cv::Mat out = stored.clone();
    if (orientation >= 5)
        cv::transpose(out, out);
    if (orientation == 2 || orientation == 6)
        cv::flip(out, out, left_right);
    if (orientation == 4 || orientation == 8)
        cv::flip(out, out, up_down);
    if (orientation == 3 || orientation == 7)
        cv::flip(out, out, both);
    return out;
}

static void every_kind_is_turned_as_its_orientation_says(void **)
{
    const Bytes png = encoded(".png"), webp = encoded(".webp"), tiff = encoded(".tiff"),
                deep = encoded(".tiff", noise<uint16_t>(CV_16UC3));
    const cv::Mat webp_stored = decoded(webp), deep_stored = decoded(deep);
    for (uint8_t orientation = 1; orientation <= 8; orientation++) {
        const cv::Mat expected = turned(bgr, orientation);
        assert_pixels(decoded(tiff_with(tiff, 274, orientation)), expected);
        assert_pixels(decoded(tiff_with(deep, 274, orientation)), turned(deep_stored, orientation));
        for (const bool little : {false, true}) {
            const Bytes block = exif_block(orientation, little);
            assert_pixels(decoded(png_with_exif(png, block)), expected);
            assert_pixels(decoded(png_with_exif(png, block, true)), expected);
            assert_pixels(decoded(webp_with_exif(webp, block)), turned(webp_stored, orientation));
            Bytes as_in_jpeg = {'E', 'x', 'i', 'f', 0, 0};
            as_in_jpeg.insert(as_in_jpeg.end(), block.begin(), block.end());
            assert_pixels(decoded(webp_with_exif(webp, as_in_jpeg)),
                          turned(webp_stored, orientation));
        }
    }
}

static void a_damaged_orientation_is_none(void **)
{
    const Bytes png = encoded(".png"), webp = encoded(".webp");
    Bytes far = exif_block(6);
    far[4] = 0xFF; // its directory begins behind the end
    for (const Bytes &block : {Bytes{}, Bytes{'I', 'I'}, far, exif_block(0), exif_block(9)}) {
        assert_pixels(decoded(png_with_exif(png, block)), bgr);
        assert_pixels(decoded(webp_with_exif(webp, block)), decoded(webp));
    }
    assert_pixels(decoded(tiff_with(encoded(".tiff"), 274, 9)), bgr);
}

static void a_tiff_file_with_other_pixels_than_we_read_is_refused_by_name(void **)
{
    struct Case {
        int type;
        uint16_t tag, value;
        const char *name;
    };
    const Case cases[] = {
        {CV_8UC3, 262, 5, "CMYK"},           {CV_8UC3, 262, 8, "CIELab"},
        {CV_8UC3, 262, 32803, "raw sensor"}, {CV_8UC3, 262, 34892, "kind 34892"},
        {CV_8UC3, 50706, 1, "DNG"},          {CV_8UC3, 277, 5, "5 channels"},
        {CV_8UC1, 339, 3, "floating"},       {CV_16UC1, 339, 2, "signed"},
        {CV_8UC1, 258, 12, "12 bits"},       {CV_16UC1, 258, 32, "32 bits"},
        {CV_16UC1, 262, 0, "white is 0"},    {CV_16UC1, 277, 2, "transparency"},
        {CV_16UC3, 284, 2, "in planes"},     {CV_16UC1, 262, 3, "palette"},
    };
    for (const Case &c : cases) {
        const cv::Mat pixels(height, width, c.type, cv::Scalar::all(100));
        const std::string reason =
            refusal(tiff_with(encoded(".tiff", pixels), c.tag, c.value), VDNA_ERR_UNSUPPORTED);
        if (reason.find(c.name) == std::string::npos)
            fail_msg("tag %d: expected \"%s\" in: %s", c.tag, c.name, reason.c_str());
    }
    refusal(encoded(".tiff", cv::Mat(height, width, CV_32FC1, cv::Scalar(1))),
            VDNA_ERR_UNSUPPORTED);
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

static void known_kinds_that_are_not_read_are_refused_by_name(void **)
{
    struct Case {
        std::string begin;
        const char *name;
    };
    using namespace std::string_literals;
    for (const Case &c :
         {Case{"GIF89a"s, "a GIF"},
          Case{"\0\0\0\x18"
               "ftypheic"s,
               "a HEIC"},
          Case{"\0\0\0\x1c"
               "ftypavif"s,
               "a AVIF"},
          Case{"\0\0\0\x0cJXL \r\n\x87\n"s, "a JPEG XL"},
          Case{"\0\0\0\x0cjP  \r\n\x87\n"s, "a JPEG 2000"}, Case{"P7\nWIDTH 4"s, "a PAM"},
          Case{"II*\0\x10\0\0\0CR\x02\0"s, "a CR2"}, Case{"II+\0"s, "a BigTIFF"}}) {
        const std::string reason =
            refusal(Bytes(c.begin.begin(), c.begin.end()), VDNA_ERR_UNSUPPORTED);
        assert_true(reason.find("is "s + c.name) != std::string::npos);
        assert_true(reason.find("convert it to") != std::string::npos);
    }
    Bytes animated = webp_with_exif(encoded(".webp"), {});
    animated[20] |= 2;
    assert_true(refusal(animated, VDNA_ERR_UNSUPPORTED).find("animated") != std::string::npos);
}

static void endings_are_lower_case_and_read_or_not_read(void **)
{
    for (const std::string_view ending : picture::file_endings)
        assert_int_equal(std::count(picture::unreadable_endings.begin(),
                                    picture::unreadable_endings.end(), ending),
                         0);
    const auto is_ending = [](std::string_view text) {
        return text.size() > 1 && text[0] == '.' &&
               std::none_of(text.begin(), text.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
    };
    assert_true(std::all_of(picture::file_endings.begin(), picture::file_endings.end(), is_ending));
    assert_true(std::all_of(picture::unreadable_endings.begin(), picture::unreadable_endings.end(),
                            is_ending));
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
        cmocka_unit_test(sixteen_bits_are_scaled_to_the_nearest_of_eight_in_every_kind),
        cmocka_unit_test(a_dark_picture_of_an_unknown_depth_is_refused_and_black_is_black),
        cmocka_unit_test(pnm_pictures_are_scaled_by_their_white_as_text_and_as_bytes),
        cmocka_unit_test(damaged_pnm_pictures_are_refused),
        cmocka_unit_test(every_kind_is_turned_as_its_orientation_says),
        cmocka_unit_test(a_damaged_orientation_is_none),
        cmocka_unit_test(a_tiff_file_with_other_pixels_than_we_read_is_refused_by_name),
        cmocka_unit_test(known_kinds_that_are_not_read_are_refused_by_name),
        cmocka_unit_test(endings_are_lower_case_and_read_or_not_read),
        cmocka_unit_test(files_cut_short_are_refused),
        cmocka_unit_test(other_files_than_pictures_are_refused),
        cmocka_unit_test(a_small_file_that_claims_a_huge_picture_is_refused_unread),
    };
    return cmocka_run_group_tests_name("picture files", tests, nullptr, nullptr);
}
