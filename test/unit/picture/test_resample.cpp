// Resizing: small pictures by hand, others beside OpenCV.
#include <algorithm>
#include <cstdlib>
#include <vector>

#include <cmocka.hpp>
#include <counted_new.hpp>
#include <opencv2/imgproc.hpp>

#include "picture/resample.hpp"

using namespace vdna::picture;

static uint32_t random_state = 1;

static int random_from(int least, int most)
{
    random_state = random_state * 1664525u + 1013904223u;
    return least + static_cast<int>((random_state >> 8) % static_cast<uint32_t>(most - least + 1));
}

static cv::Mat noise(cv::Size size, int channels)
{
    // Rows of a wider picture, so that they are not contiguous.
    cv::Mat wider(size.height, size.width + 3, CV_8UC(channels));
    for (int y = 0; y < wider.rows; y++)
        for (int i = 0; i < wider.cols * channels; i++) {
            const int level = random_from(0, 511);
            wider.ptr(y)[i] = static_cast<uint8_t>(level < 256 ? level : level % 2 ? 255 : 0);
        }
    return wider.colRange(0, size.width);
}

static vdna_pixels pixels_of(const cv::Mat &picture)
{
    const auto channels = static_cast<uint32_t>(picture.channels());
    const uint32_t colour = channels > 1 ? 1 : 0;
    return {picture.data,
            picture.step,
            static_cast<uint32_t>(picture.cols),
            static_cast<uint32_t>(picture.rows),
            channels,
            {0, colour, 2 * colour}};
}

static cv::Mat resized(Resampler &resampler, const cv::Mat &picture, cv::Size to)
{
    cv::Mat out(to, picture.type());
    resampler.begin(pixels_of(picture));
    for (int y = 0; y < to.height; y++)
        resampler.next_row(out.ptr(y));
    return out;
}

static cv::Mat resized(Interpolation how, const cv::Mat &picture, cv::Size to)
{
    Resampler resampler(how, {static_cast<uint32_t>(to.width), static_cast<uint32_t>(to.height)});
    return resized(resampler, picture, to);
}

// A grey row of `levels` becomes `expected`, and so do a column and a colour picture of it.
static void assert_row(Interpolation how, const std::vector<uint8_t> &levels,
                       const std::vector<uint8_t> &expected)
{
    const auto from = static_cast<int>(levels.size()), to = static_cast<int>(expected.size());
    const cv::Mat row(1, from, CV_8UC1, const_cast<uint8_t *>(levels.data()));
    const cv::Mat column(from, 1, CV_8UC1, const_cast<uint8_t *>(levels.data()));
    cv::Mat colour;
    cv::merge(std::vector<cv::Mat>(3, row), colour);
    const cv::Mat of_row = resized(how, row, {to, 1}), of_column = resized(how, column, {1, to});
    const cv::Mat of_colour = resized(how, colour, {to, 1});
    for (size_t i = 0; i < expected.size(); i++) {
        assert_int_equal(of_row.data[i], expected[i]);
        assert_int_equal(of_column.data[i], expected[i]);
        for (size_t c = 0; c < 3; c++)
            assert_int_equal(of_colour.data[3 * i + c], expected[i]);
    }
}

static void area_is_the_mean_of_what_a_pixel_covers(void **)
{
    // One and a half pixels each: (0 + 90 / 2) / 1.5 and (90 / 2 + 180) / 1.5.
    assert_row(Interpolation::area, {0, 90, 180}, {30, 150});
    assert_row(Interpolation::area, {0, 100, 200, 50, 10},
               {80, 64}); // (0 + 100 + 200 / 2) / 2.5 ...
    assert_row(Interpolation::area, {7, 8, 9}, {7, 8, 9});
}

static void whole_blocks_are_rounded_as_opencv_rounds_them(void **)
{
    assert_row(Interpolation::area, {0, 0, 1, 1}, {0});          // 0.5 to the even level
    assert_row(Interpolation::area, {1, 1, 2, 2, 9, 9}, {1, 7}); // 4/3 and 20/3
    const uint8_t four[] = {0, 0, 1, 1};
    const cv::Mat square(2, 2, CV_8UC1, const_cast<uint8_t *>(four));
    assert_int_equal(resized(Interpolation::area, square, {1, 1}).data[0], 1); // of 2x2 upwards
    assert_int_equal(resized(Interpolation::linear, square, {1, 1}).data[0], 1);
}

static void area_that_grows_blends_only_where_a_pixel_covers_two(void **)
{
    assert_row(Interpolation::area, {0, 100}, {0, 0, 100, 100});
    assert_row(Interpolation::area, {0, 100}, {0, 50, 100});
}

static void linear_blends_two_pixels(void **)
{
    assert_row(Interpolation::linear, {0, 100}, {0, 25, 75, 100});
    assert_row(Interpolation::linear, {10, 20, 30, 40, 50, 60}, {15, 35, 55});
}

static void cubic_blends_four_pixels_and_stays_within_the_levels(void **)
{
    // At a quarter: -0.10546875, 0.87890625, 0.26171875, -0.03515625.
    assert_row(Interpolation::cubic, {0, 0, 255, 255}, {0, 0, 0, 58, 197, 255, 255, 255});
    assert_row(Interpolation::cubic, {77, 77, 77}, {77, 77, 77, 77, 77});
}

static cv::Size random_size(cv::Size to)
{
    switch (random_from(0, 3)) {
    case 0: // whole ratios
        return {to.width * random_from(1, 4), to.height * random_from(1, 4)};
    case 1: // one of them whole
        return {to.width * random_from(1, 4), random_from(1, 300)};
    default:
        return {random_from(1, 300), random_from(1, 300)};
    }
}

struct Difference {
    size_t bytes = 0;
    int largest = 0;
};

static Difference between(const cv::Mat &a, const cv::Mat &b)
{
    Difference difference;
    for (int y = 0; y < a.rows; y++)
        for (int i = 0; i < a.cols * a.channels(); i++) {
            const int levels = std::abs(a.ptr(y)[i] - b.ptr(y)[i]);
            difference.bytes += levels != 0 ? 1 : 0;
            difference.largest = std::max(difference.largest, levels);
        }
    return difference;
}

struct Way {
    Interpolation ours;
    int opencv;
    const char *name;
};
static const Way ways[] = {{Interpolation::area, cv::INTER_AREA, "area"},
                           {Interpolation::linear, cv::INTER_LINEAR, "linear"},
                           {Interpolation::cubic, cv::INTER_CUBIC, "cubic"}};

static void assert_as_opencv(const Way &way, cv::Size from, cv::Size to, int channels)
{
    const cv::Mat picture = noise(from, channels);
    cv::Mat expected;
    cv::resize(picture, expected, to, 0, 0, way.opencv);
    const Difference found = between(resized(way.ours, picture, to), expected);
    // `area` may sum floats in another order than OpenCV, so one in a thousand may round
    // differently.
    const bool is_whole = from.width % to.width == 0 && from.height % to.height == 0;
    const bool sums_floats = way.ours == Interpolation::area && !is_whole &&
                             from.width >= to.width && from.height >= to.height;
    const size_t allowed = sums_floats ? expected.total() * expected.elemSize() / 50 + 1 : 0;
    if (found.bytes > allowed || found.largest > 1)
        fail_msg("%s, %dx%d to %dx%d, %d channels: %zu bytes differ, by up to %d", way.name,
                 from.width, from.height, to.width, to.height, channels, found.bytes,
                 found.largest);
}

static void usual_sizes_give_the_bytes_of_opencv(void **)
{
    const struct {
        cv::Size from, to;
        int channels;
    } cases[] = {
        {{640, 480}, {224, 224}, 3}, {{640, 480}, {224, 224}, 1}, {{640, 480}, {224, 224}, 4},
        {{512, 192}, {224, 192}, 3}, {{448, 448}, {224, 224}, 3}, {{1920, 1080}, {640, 480}, 3},
        {{225, 224}, {224, 224}, 3}, {{7, 5}, {1, 1}, 3},         {{100, 75}, {224, 224}, 3},
        {{224, 224}, {224, 224}, 3}, {{640, 100}, {224, 224}, 3}, {{1920, 1080}, {224, 224}, 3},
    };
    for (const auto &c : cases)
        for (const Way &way : ways)
            assert_as_opencv(way, c.from, c.to, c.channels);
}

static void any_size_gives_the_bytes_of_opencv(void **)
{
    for (int n = 0; n < 600; n++) {
        const int channels[] = {1, 3, 4};
        const cv::Size to(random_from(1, 300), random_from(1, 300)), from = random_size(to);
        for (const Way &way : ways)
            assert_as_opencv(way, from, to, channels[n % 3]);
    }
}

static const Interpolation all[] = {Interpolation::area, Interpolation::linear,
                                    Interpolation::cubic, Interpolation::pillow_bicubic};

static void a_picture_of_another_size_is_resized_as_if_it_were_the_first(void **)
{
    const cv::Size to(20, 10);
    for (const Interpolation how : all) {
        Resampler used(how, {20, 10});
        for (const cv::Size size : {cv::Size(64, 48), cv::Size(40, 20), cv::Size(20, 10),
                                    cv::Size(5, 7), cv::Size(33, 77), cv::Size(300, 3)})
            for (const int channels : {3, 1, 4}) {
                const cv::Mat picture = noise(size, channels);
                const cv::Mat again = resized(used, picture, to);
                assert_int_equal(between(again, resized(how, picture, to)).bytes, 0);
            }
    }
}

static void no_picture_costs_an_allocation(void **)
{
    const cv::Mat large = noise({2000, 1500}, 4);
    uint8_t row[4 * 224];
    for (const Interpolation how : all) {
        Resampler resampler(how, {224, 224});
        const size_t before = allocations;
        for (const uint32_t width : {640u, 448u, 224u, 100u, 1u, 2000u})
            for (const uint32_t height : {480u, 448u, 224u, 100u, 1u, 1500u})
                for (const uint32_t channels : {1u, 3u, 4u}) {
                    resampler.begin({large.data, large.step, width, height, channels, {0, 0, 0}});
                    for (int y = 0; y < 224; y++)
                        resampler.next_row(row);
                }
        assert_int_equal(allocations, before);
    }
}

static void the_longest_picture_fits_what_was_reserved(void **)
{
    const std::vector<uint8_t> line(4 * VDNA_IMAGE_SIDE_MAX, 200);
    uint8_t row[4 * 3];
    for (const Interpolation how : all) {
        Resampler resampler(how, {3, 3});
        const size_t before = allocations;
        for (const bool is_wide : {false, true}) {
            const uint32_t width = is_wide ? VDNA_IMAGE_SIDE_MAX : 1;
            const uint32_t height = is_wide ? 1 : VDNA_IMAGE_SIDE_MAX;
            resampler.begin({line.data(), 4 * width, width, height, 4, {0, 1, 2}});
            for (int y = 0; y < 3; y++) {
                resampler.next_row(row);
                for (const uint8_t level : row)
                    assert_int_equal(level, 200);
            }
        }
        assert_int_equal(allocations, before);
    }
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(area_is_the_mean_of_what_a_pixel_covers),
        cmocka_unit_test(whole_blocks_are_rounded_as_opencv_rounds_them),
        cmocka_unit_test(area_that_grows_blends_only_where_a_pixel_covers_two),
        cmocka_unit_test(linear_blends_two_pixels),
        cmocka_unit_test(cubic_blends_four_pixels_and_stays_within_the_levels),
        cmocka_unit_test(usual_sizes_give_the_bytes_of_opencv),
        cmocka_unit_test(any_size_gives_the_bytes_of_opencv),
        cmocka_unit_test(a_picture_of_another_size_is_resized_as_if_it_were_the_first),
        cmocka_unit_test(no_picture_costs_an_allocation),
        cmocka_unit_test(the_longest_picture_fits_what_was_reserved),
    };
    return cmocka_run_group_tests_name("resample", tests, nullptr, nullptr);
}
