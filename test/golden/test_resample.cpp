// Resizing against Pillow and the code that made existing maps.
#include <vector>

#include <cmocka.hpp>

#include "area_golden.h"
#include "noise.hpp"
#include "picture/resample.hpp"
#include "pillow_golden.h"

using namespace vdna::picture;

using Bytes = std::vector<uint8_t>;

// Noise of a golden case, resized; fourth channels are left out.
template <class Golden>
static uint64_t hash_of(Interpolation how, const Golden &golden)
{
    const auto width = static_cast<uint32_t>(golden.width);
    const auto height = static_cast<uint32_t>(golden.height);
    const auto channels = static_cast<uint32_t>(golden.channels);
    const Size to = {static_cast<uint32_t>(golden.to_width),
                     static_cast<uint32_t>(golden.to_height)};
    const Bytes picture = noise(size_t{width} * height * channels);
    Resampler resampler(how, to);
    resampler.begin({picture.data(), size_t{width} * channels, width, height, channels, {0, 0, 0}});

    Bytes row(to.width * channels_max);
    uint64_t hash = 0xcbf29ce484222325;
    for (uint32_t y = 0; y < to.height; y++) {
        resampler.next_row(row.data());
        for (uint32_t i = 0; i < to.width * channels; i++)
            if (i % channels != 3)
                hash = (hash ^ row[i]) * 0x100000001b3;
    }
    return hash;
}

template <class Goldens>
static void assert_hashes(Interpolation how, const Goldens &goldens, const char *peer)
{
    for (const auto &golden : goldens)
        if (hash_of(how, golden) != golden.fnv1a)
            fail_msg("%dx%d to %dx%d, %d channels: not what %s gives", golden.width, golden.height,
                     golden.to_width, golden.to_height, golden.channels, peer);
}

static void pillow_bicubic_equals_pillow_to_the_last_bit(void **)
{
    assert_hashes(Interpolation::pillow_bicubic, pillow_golden, "Pillow");
}

static void area_gives_the_bytes_that_maps_were_made_with(void **)
{
    assert_hashes(Interpolation::area, area_golden, "the code before");
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(pillow_bicubic_equals_pillow_to_the_last_bit),
        cmocka_unit_test(area_gives_the_bytes_that_maps_were_made_with),
    };
    return cmocka_run_group_tests_name("golden resample", tests, nullptr, nullptr);
}
