#include <algorithm>
#include <cstring>

#include <opencv2/core.hpp>

#include <vdna/cpp/error.hpp>

#include "cmocka.hpp"
#include "eval/disturbance.hpp"

using namespace vdna;

namespace
{

// White on the right, black on the left.
cv::Mat scene()
{
    cv::Mat picture(20, 40, CV_8UC3, cv::Scalar(0, 0, 0));
    picture.colRange(20, 40).setTo(cv::Scalar(255, 255, 255));
    return picture;
}

cv::Mat disturbed(const char *key, uint32_t seed = 1)
{
    std::mt19937 random(seed);
    const auto found =
        std::find_if(eval::disturbances.begin(), eval::disturbances.end(),
                     [&](const eval::Disturbance &d) { return std::strcmp(d.key, key) == 0; });
    return found->picture(scene(), random);
}

double lowest(const cv::Mat &picture)
{
    double low = 0;
    cv::minMaxLoc(picture.reshape(1), &low);
    return low;
}

double highest(const cv::Mat &picture)
{
    double high = 0;
    cv::minMaxLoc(picture.reshape(1), nullptr, &high);
    return high;
}

void every_disturbed_picture_is_as_large_as_the_scene(void **)
{
    for (const eval::Disturbance &disturbance : eval::disturbances) {
        const cv::Mat picture = disturbed(disturbance.key);
        assert_true(picture.size() == scene().size() && picture.type() == CV_8UC3);
    }
}

void levels_are_those_of_each_disturbance(void **)
{
    assert_true(highest(disturbed("black")) == 0 && lowest(disturbed("white")) == 255);
    assert_true(highest(disturbed("lens cap")) == 15 && lowest(disturbed("lens cap")) == 0);
    assert_true(highest(disturbed("noise")) > 250 && lowest(disturbed("noise")) < 5);
}

void noise_is_another_with_each_picture_and_the_same_with_each_run(void **)
{
    assert_true(cv::norm(disturbed("noise"), disturbed("noise")) == 0);
    assert_true(cv::norm(disturbed("noise"), disturbed("noise", 2)) > 0);
}

void a_blur_mixes_what_is_beside_and_keeps_what_is_far(void **)
{
    const cv::Mat picture = disturbed("blur"); // sigma 2
    assert_true(picture.ptr(10)[3 * 20] > 128 && picture.ptr(10)[3 * 20] < 200);
    assert_true(picture.ptr(10)[0] == 0 && picture.ptr(10)[3 * 39] == 255);
}

void what_is_no_picture_is_named(void **)
{
    for (const std::vector<uint8_t> &bytes : {std::vector<uint8_t>{}, {'P', '6', 1, 2}})
        try {
            eval::decoded(bytes, "frame.ppm");
            fail();
        } catch (const Error &error) {
            assert_true(std::string(error.what()).rfind("frame.ppm: ", 0) == 0);
        }
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(every_disturbed_picture_is_as_large_as_the_scene),
        cmocka_unit_test(levels_are_those_of_each_disturbance),
        cmocka_unit_test(noise_is_another_with_each_picture_and_the_same_with_each_run),
        cmocka_unit_test(a_blur_mixes_what_is_beside_and_keeps_what_is_far),
        cmocka_unit_test(what_is_no_picture_is_named),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
