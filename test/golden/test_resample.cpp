// Resizing of our own, against Pillow and OpenCV.
#include <cstdio>

#include <cmocka.hpp>
#include <opencv2/imgproc.hpp>

#include "pillow_golden.h"
#include "preprocess.hpp"

using namespace vdna::backbone;

// As in make_pillow.py.
static cv::Mat noise(int width, int height, int channels)
{
    cv::Mat picture(height, width, CV_8UC(channels));
    uint32_t state = 1;
    for (size_t i = 0; i < picture.total() * picture.elemSize(); i++) {
        state = state * 1664525u + 1013904223u;
        const uint32_t levels[] = {0, 255, state >> 16 & 255, state >> 8 & 255};
        picture.data[i] = static_cast<uint8_t>(levels[state >> 30]);
    }
    return picture;
}

static uint64_t fnv1a(const cv::Mat &picture)
{
    uint64_t hash = 0xcbf29ce484222325;
    for (size_t i = 0; i < picture.total() * picture.elemSize(); i++)
        hash = (hash ^ picture.data[i]) * 0x100000001b3;
    return hash;
}

static void pillow_bicubic_equals_pillow_to_the_last_bit(void **)
{
    for (const auto &golden : pillow_golden) {
        const cv::Mat picture = noise(golden.width, golden.height, golden.channels);
        PillowResampler resampler(picture.size(), {golden.to_width, golden.to_height});
        cv::Mat resized;
        resampler.run(picture, resized);
        if (fnv1a(resized) != golden.fnv1a)
            fail_msg("%dx%d to %dx%d, %d channels: not what Pillow gives", golden.width,
                     golden.height, golden.to_width, golden.to_height, golden.channels);
    }
}

// What the network is given, as levels 0..255: mean 0 and deviation 1.
static std::vector<float> prepared(const cv::Mat &picture, cv::Size size, Interpolation how)
{
    const Input input{"image",
                      static_cast<uint32_t>(size.width),
                      static_cast<uint32_t>(size.height),
                      false,
                      {0, 0, 0},
                      {1, 1, 1},
                      how};
    std::vector<float> out(3 * static_cast<size_t>(size.area()));
    const bool grey = picture.channels() == 1;
    Preprocessor preprocessor(input);
    preprocessor.run({picture, {0, grey ? 0 : 1, grey ? 0 : 2}}, out.data());
    return out;
}

// Sums of floats in another order may round the other way, once in a thousand.
static void area_equals_opencv(void **)
{
    const struct {
        cv::Size from, to;
        int channels;
    } cases[] = {
        {{640, 480}, {224, 224}, 3}, {{640, 480}, {224, 224}, 1}, {{640, 480}, {224, 224}, 4},
        {{512, 192}, {224, 192}, 3}, {{448, 448}, {224, 224}, 3}, {{1920, 1080}, {640, 480}, 3},
        {{225, 224}, {224, 224}, 3}, {{7, 5}, {1, 1}, 3},         {{100, 75}, {224, 224}, 3},
        {{224, 224}, {224, 224}, 3}, {{640, 100}, {224, 224}, 3},
    };
    for (const auto &c : cases) {
        const cv::Mat picture = noise(c.from.width, c.from.height, c.channels);
        const std::vector<float> found = prepared(picture, c.to, Interpolation::area);
        cv::Mat expected;
        cv::resize(picture, expected, c.to, 0, 0, cv::INTER_AREA);
        const auto pixels = static_cast<size_t>(c.to.area());
        size_t other = 0;
        for (size_t i = 0; i < 3 * pixels; i++) {
            const size_t channel = c.channels == 1 ? 0 : i / pixels;
            const int level = expected.data[i % pixels * expected.elemSize() + channel];
            const float difference = found[i] - static_cast<float>(level);
            if (difference < -1 || difference > 1)
                fail_msg("%dx%d to %dx%d: value %zu is %g, expected %d", c.from.width,
                         c.from.height, c.to.width, c.to.height, i, static_cast<double>(found[i]),
                         level);
            other += difference != 0 ? 1 : 0;
        }
        if (other > 3 * pixels / 1000)
            fail_msg("%dx%d to %dx%d: %zu of %zu values differ", c.from.width, c.from.height,
                     c.to.width, c.to.height, other, 3 * pixels);
    }
}

static void a_picture_of_another_size_is_resized_as_if_it_were_the_first(void **)
{
    const Input input{"image", 20, 10, true, {1, 2, 3}, {4, 5, 6}, Interpolation::area};
    Preprocessor used(input);
    std::vector<float> first(600), again(600);
    for (const cv::Size size : {cv::Size(64, 48), cv::Size(20, 10), cv::Size(33, 77)}) {
        const Picture picture{noise(size.width, size.height, 3), {0, 1, 2}};
        Preprocessor fresh(input);
        used.run(picture, again.data());
        fresh.run(picture, first.data());
        assert_true(first == again);
    }
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(pillow_bicubic_equals_pillow_to_the_last_bit),
        cmocka_unit_test(area_equals_opencv),
        cmocka_unit_test(a_picture_of_another_size_is_resized_as_if_it_were_the_first),
    };
    return cmocka_run_group_tests_name("golden resample", tests, nullptr, nullptr);
}
