// Camera frames as JPEGs for a browser.
#include <vector>

#include <vdna/cpp/error.hpp>

#include "cmocka.hpp"
#include "picture/jpeg.h"
#include "serve/camera_jpeg.hpp"

namespace
{

using vdna::serve::CameraJpeg;

// A raw picture of one colour, whose pixels the image borrows.
vdna_image picture_of(std::vector<uint8_t> &pixels, uint32_t width, uint32_t height,
                      uint32_t format, const std::vector<uint8_t> &colour)
{
    pixels.clear();
    for (size_t i = 0; i < size_t{width} * height; i++)
        pixels.insert(pixels.end(), colour.begin(), colour.end());
    return {pixels.data(), pixels.size(), width, height, 0, format};
}

vdna_image as_image(const std::string &jpeg)
{
    return {reinterpret_cast<const uint8_t *>(jpeg.data()), jpeg.size(), 0, 0, 0, VDNA_PIXEL_MJPG};
}

void expect_shape(const std::string &jpeg, uint32_t width, uint32_t height, uint32_t channels)
{
    char reason[VDNA_JPEG_REASON_MAX];
    vdna_jpeg_shape shape;
    const vdna_image image = as_image(jpeg);
    assert_true(vdna_jpeg_shape_of(image.data, image.size, &shape, reason));
    assert_int_equal(shape.width, width);
    assert_int_equal(shape.height, height);
    assert_int_equal(shape.channels, channels);
}

void a_raw_picture_keeps_its_colours(void **)
{
    std::vector<uint8_t> pixels;
    vdna_decoder *decoder = nullptr;
    assert_int_equal(vdna_decoder_open(10000, nullptr, &decoder), VDNA_OK);
    for (const uint32_t format :
         {VDNA_PIXEL_RGB3, VDNA_PIXEL_BGR3, VDNA_PIXEL_RGB4, VDNA_PIXEL_BGR4}) {
        const bool wide = format == VDNA_PIXEL_RGB4 || format == VDNA_PIXEL_BGR4;
        const bool red_first = format == VDNA_PIXEL_RGB3 || format == VDNA_PIXEL_RGB4;
        std::vector<uint8_t> colour{uint8_t(red_first ? 200 : 40), 90,
                                    uint8_t(red_first ? 40 : 200)};
        if (wide)
            colour.push_back(7);
        const std::string jpeg = CameraJpeg().of(picture_of(pixels, 32, 16, format, colour));
        expect_shape(jpeg, 32, 16, 3);
        const vdna_image encoded = as_image(jpeg);
        vdna_pixels seen;
        assert_int_equal(vdna_decoder_decode(decoder, &encoded, nullptr, &seen), VDNA_OK);
        const uint8_t expected[] = {200, 90, 40};
        for (int i = 0; i < 3; i++)
            assert_in_range(seen.data[seen.rgb[i]], expected[i] - 4, expected[i] + 4);
    }
    vdna_decoder_close(decoder);
}

void a_large_picture_becomes_small(void **)
{
    std::vector<uint8_t> pixels;
    CameraJpeg maker;
    expect_shape(maker.of(picture_of(pixels, 1920, 1080, VDNA_PIXEL_GREY, {50})), 640, 360, 1);
    expect_shape(maker.of(picture_of(pixels, 3, 1281, VDNA_PIXEL_GREY, {50})), 1, 640, 1);
    expect_shape(maker.of(picture_of(pixels, 640, 480, VDNA_PIXEL_GREY, {50})), 640, 480, 1);
}

void a_jpeg_is_handed_on_as_it_came(void **)
{
    std::vector<uint8_t> pixels;
    CameraJpeg maker;
    const std::string jpeg = maker.of(picture_of(pixels, 64, 64, VDNA_PIXEL_GREY, {50}));
    assert_true(maker.of(as_image(jpeg)) == jpeg);
    vdna_image file = as_image(jpeg);
    file.pixelformat = VDNA_PIXEL_ENCODED;
    assert_true(maker.of(file) == jpeg);
}

void a_jpeg_of_many_bytes_is_made_small(void **)
{
    std::vector<uint8_t> pixels;
    CameraJpeg maker;
    vdna_image noise = picture_of(pixels, 640, 640, VDNA_PIXEL_RGB3, {0, 0, 0});
    uint32_t random = 1;
    for (uint8_t &pixel : pixels)
        pixel = static_cast<uint8_t>((random = random * 1664525u + 1013904223u) >> 24);
    const std::string jpeg = maker.of(noise);
    assert_true(jpeg.size() > CameraJpeg::as_received_max);
    assert_false(maker.of(as_image(jpeg)) == jpeg); // encoded anew
}

void a_damaged_picture_is_refused(void **)
{
    const auto refuses = [](const vdna_image &image) {
        try {
            CameraJpeg().of(image);
            return false;
        } catch (const vdna::Error &) {
            return true;
        }
    };
    assert_true(refuses(as_image("no JPEG")));
    std::vector<uint8_t> pixels;
    vdna_image image = picture_of(pixels, 32, 32, VDNA_PIXEL_GREY, {50});
    image.height = 33;
    assert_true(refuses(image));
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_raw_picture_keeps_its_colours),
        cmocka_unit_test(a_large_picture_becomes_small),
        cmocka_unit_test(a_jpeg_is_handed_on_as_it_came),
        cmocka_unit_test(a_jpeg_of_many_bytes_is_made_small),
        cmocka_unit_test(a_damaged_picture_is_refused),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
