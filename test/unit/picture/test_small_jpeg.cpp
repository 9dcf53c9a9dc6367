// Small JPEGs: their shape, and that they fit.
#include <cstdint>
#include <vector>

#include <cmocka.hpp>

#include <vdna/picture.h>

#include "picture/small_jpeg.hpp"

using namespace vdna::picture;

namespace
{

// Noise, which no encoder makes small.
vdna_pixels noise(std::vector<uint8_t> &bytes, uint32_t width, uint32_t height, uint32_t channels)
{
    bytes.resize(size_t{width} * height * channels);
    uint32_t state = 1;
    for (uint8_t &byte : bytes) {
        state = state * 1664525u + 1013904223u;
        byte = static_cast<uint8_t>(state >> 24);
    }
    return {bytes.data(), size_t{width} * channels,
            width,        height,
            channels,     {0, channels > 1, channels > 1 ? 2u : 0u}};
}

void expect_shape(const std::string &jpeg, uint32_t width, uint32_t height)
{
    vdna_decoder *decoder = nullptr;
    vdna_pixels seen;
    const vdna_image image{reinterpret_cast<const uint8_t *>(jpeg.data()),
                           jpeg.size(),
                           width,
                           height,
                           0,
                           VDNA_PIXEL_MJPG};
    assert_int_equal(vdna_decoder_open(1 << 20, nullptr, &decoder), VDNA_OK);
    assert_int_equal(vdna_decoder_decode(decoder, &image, nullptr, &seen), VDNA_OK);
    assert_int_equal(seen.width, width);
    assert_int_equal(seen.height, height);
    vdna_decoder_close(decoder);
}

void the_longer_side_is_made_small_and_the_aspect_kept(void **)
{
    std::vector<uint8_t> bytes;
    Shrinker shrinker(160);
    const auto expect = [&](uint32_t from_width, uint32_t from_height, uint32_t width,
                            uint32_t height) {
        const vdna_pixels small = shrinker.shrink(noise(bytes, from_width, from_height, 3));
        assert_int_equal(small.width, width);
        assert_int_equal(small.height, height);
        assert_int_equal(small.channels, 3);
    };
    expect(640, 480, 160, 120);
    expect(480, 640, 120, 160);
    expect(1000, 3, 160, 1);
    expect(640, 480, 160, 120);
    const vdna_pixels little = noise(bytes, 160, 20, 3);
    assert_ptr_equal(shrinker.shrink(little).data, little.data);
}

void a_jpeg_fits_at_the_best_quality_that_does(void **)
{
    std::vector<uint8_t> bytes;
    for (const uint32_t channels : {1u, 3u, 4u}) {
        const vdna_pixels busy = noise(bytes, 160, 120, channels);
        const std::string jpeg = jpeg_within(busy, 4096);
        assert_in_range(jpeg.size(), 1, 4096);
        expect_shape(jpeg, 160, 120);
        const std::string better = jpeg_within(busy, 100000);
        assert_true(better.size() > 4096);
        assert_true(better.size() <= jpeg_of(busy, 80).size()); // tables of its own
    }
}

void where_none_fits_there_is_none(void **)
{
    std::vector<uint8_t> bytes;
    assert_true(jpeg_within(noise(bytes, 160, 120, 3), 100).empty());
}

} // namespace

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_longer_side_is_made_small_and_the_aspect_kept),
        cmocka_unit_test(a_jpeg_fits_at_the_best_quality_that_does),
        cmocka_unit_test(where_none_fits_there_is_none),
    };
    return cmocka_run_group_tests_name("small_jpeg", tests, nullptr, nullptr);
}
