// Frame health against rendered faults and rendered pictures that look like faults, a hundred
// seeded scripts of each: raw, and as JPEG of any quality. Prints how near they come to the limits.
//
//     test_unit_health_faults [SCRIPTS]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <vdna/health.h>
#include <vdna/picture.h>

#include "cmocka.hpp"

namespace
{

unsigned scripts = 100;
constexpr int own_frames = 2;      // of a script whose every frame is a fault
constexpr int frames_of_many = 24; // of a script whose frames are faults one after the other
constexpr uint64_t distinct_min = 10;

// Random numbers that are the same everywhere.
class Chance
{
  public:
    explicit Chance(uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15u + 1) { next(); }

    uint32_t next()
    {
        state_ ^= state_ >> 12;
        state_ ^= state_ << 25;
        state_ ^= state_ >> 27;
        return static_cast<uint32_t>(state_ * 2685821657736338717u >> 32);
    }
    double between(double low, double high) { return low + (high - low) * next() / 4294967296.0; }
    int whole(int low, int high) // both included
    {
        return low + static_cast<int>(next() % static_cast<uint32_t>(high - low + 1));
    }
    // Variance 1, from the sum of the four bytes.
    double normal()
    {
        const uint32_t n = next();
        return ((n & 255) + (n >> 8 & 255) + (n >> 16 & 255) + (n >> 24) - 510.0) / 147.8;
    }

  private:
    uint64_t state_;
};

struct Script {
    explicit Script(uint64_t seed) : chance(seed) {}

    Chance chance;
    cv::Size size;
    bool is_jpeg = false;
    int quality = 90;
};

Script begin(uint64_t seed, int quality_min)
{
    static const std::array<cv::Size, 8> sizes = {cv::Size(96, 72),   {160, 120}, {160, 120},
                                                  cv::Size(224, 224), {320, 240}, {320, 180},
                                                  cv::Size(512, 192), {640, 480}};
    Script script(seed);
    script.size = sizes[static_cast<size_t>(script.chance.whole(0, 7))];
    script.is_jpeg = script.chance.whole(0, 1) == 1;
    script.quality = script.chance.whole(quality_min, 98);
    return script;
}

cv::Mat plain(const Script &script, double level)
{
    return cv::Mat(script.size, CV_32FC1, cv::Scalar(level));
}

void add_noise(cv::Mat &picture, Chance &chance, double deviation)
{
    for (int y = 0; y < picture.rows; y++) {
        float *row = picture.ptr<float>(y);
        for (int x = 0; x < picture.cols; x++)
            row[x] += static_cast<float>(deviation * chance.normal());
    }
}

// Levels as a camera gives them: BGR, clamped.
cv::Mat as_camera(const cv::Mat &grey)
{
    cv::Mat bytes, colours;
    grey.convertTo(bytes, CV_8U);
    cv::cvtColor(bytes, colours, cv::COLOR_GRAY2BGR);
    return colours;
}

// What the library measures of a picture that a camera sends.
class Camera
{
  public:
    Camera() { assert_int_equal(vdna_decoder_open(1u << 20, nullptr, &decoder_), VDNA_OK); }
    ~Camera() { vdna_decoder_close(decoder_); }
    Camera(const Camera &) = delete;
    Camera &operator=(const Camera &) = delete;

    vdna_health_picture measure(const cv::Mat &bgr, const Script &script)
    {
        vdna_image image{};
        if (script.is_jpeg) {
            cv::imencode(".jpg", bgr, bytes_, {cv::IMWRITE_JPEG_QUALITY, script.quality});
            image = {bytes_.data(), bytes_.size(), 0, 0, 0, VDNA_PIXEL_MJPG};
        } else {
            image = {bgr.data,
                     bgr.total() * bgr.elemSize(),
                     static_cast<uint32_t>(bgr.cols),
                     static_cast<uint32_t>(bgr.rows),
                     0,
                     VDNA_PIXEL_BGR3};
        }
        vdna_pixels pixels;
        vdna_health_picture picture;
        assert_int_equal(vdna_decoder_decode(decoder_, &image, nullptr, &pixels), VDNA_OK);
        assert_int_equal(vdna_health_measure(&pixels, &picture), VDNA_OK);
        return picture;
    }

  private:
    vdna_decoder *decoder_ = nullptr;
    std::vector<uint8_t> bytes_;
};

// ---- Faults of a picture by itself ----

cv::Mat black(Script &s)
{
    return as_camera(plain(s, s.chance.whole(0, 16)));
}

cv::Mat black_with_noise(Script &s)
{
    cv::Mat picture = plain(s, s.chance.between(0, 16));
    add_noise(picture, s.chance, s.chance.between(.5, 12));
    return as_camera(picture);
}

// A camera's sizes: below them a block of JPEG is as large as one of ours, and may be as much as 32
// levels lighter than its neighbour.
cv::Mat blocky_black(Script &s)
{
    s.size = s.chance.whole(0, 1) ? cv::Size(320, 240) : cv::Size(640, 480);
    s.is_jpeg = true;
    s.quality = s.chance.whole(1, 10);
    return black_with_noise(s);
}

cv::Mat white(Script &s)
{
    return as_camera(plain(s, s.chance.whole(235, 255)));
}

cv::Mat white_with_noise(Script &s)
{
    cv::Mat picture = plain(s, s.chance.between(235, 265));
    add_noise(picture, s.chance, s.chance.between(.5, 12));
    return as_camera(picture);
}

// A sun in the lens: all but a few places are white.
cv::Mat overexposed(Script &s)
{
    cv::Mat picture = plain(s, 255);
    for (int i = 0; i < 3; i++)
        cv::circle(picture, {s.chance.whole(0, s.size.width), s.chance.whole(0, s.size.height)},
                   s.size.height / 16, cv::Scalar(s.chance.between(0, 200)), cv::FILLED);
    add_noise(picture, s.chance, .5);
    return as_camera(picture);
}

cv::Mat grey(Script &s)
{
    return as_camera(plain(s, s.chance.whole(0, 255)));
}

cv::Mat grey_with_noise(Script &s)
{
    cv::Mat picture = plain(s, s.chance.between(0, 255));
    add_noise(picture, s.chance, s.chance.between(.5, 30));
    return as_camera(picture);
}

// Dark, darker towards the corners, with noise and hot pixels.
cv::Mat lens_cap(Script &s)
{
    const double level = s.chance.between(1, 20), falloff = s.chance.between(0, .6);
    cv::Mat picture = plain(s, 0);
    const double x0 = .5 * s.size.width, y0 = .5 * s.size.height, corner = x0 * x0 + y0 * y0;
    for (int y = 0; y < s.size.height; y++)
        for (int x = 0; x < s.size.width; x++)
            picture.at<float>(y, x) = static_cast<float>(
                level * (1 - falloff * ((x - x0) * (x - x0) + (y - y0) * (y - y0)) / corner));
    add_noise(picture, s.chance, s.chance.between(.5, 8));
    const int hot = s.size.area() / s.chance.whole(1000, 20000);
    for (int i = 0; i < hot; i++)
        picture.at<float>(s.chance.whole(0, s.size.height - 1),
                          s.chance.whole(0, s.size.width - 1)) =
            static_cast<float>(s.chance.between(60, 255));
    return as_camera(picture);
}

cv::Mat uniform_noise(Script &s)
{
    cv::Mat picture(s.size, CV_8UC1);
    for (int y = 0; y < picture.rows; y++)
        for (int x = 0; x < picture.cols; x++)
            picture.at<uint8_t>(y, x) = static_cast<uint8_t>(s.chance.next() >> 24);
    cv::cvtColor(picture, picture, cv::COLOR_GRAY2BGR);
    return picture;
}

cv::Mat colour_noise(Script &s)
{
    cv::Mat picture(s.size, CV_8UC3);
    for (int y = 0; y < picture.rows; y++)
        for (int i = 0; i < 3 * picture.cols; i++)
            picture.ptr(y)[i] = static_cast<uint8_t>(s.chance.next() >> 24);
    return picture;
}

cv::Mat salt_and_pepper(Script &s)
{
    cv::Mat picture = plain(s, s.chance.between(0, 255));
    const double share = s.chance.between(.02, 1);
    for (int y = 0; y < picture.rows; y++)
        for (int x = 0; x < picture.cols; x++)
            if (s.chance.between(0, 1) < share)
                picture.at<float>(y, x) = s.chance.whole(0, 1) ? 255.f : 0.f;
    return as_camera(picture);
}

// ---- Pictures that are none ----

// Sky above ground, boxes in front of it. Contrasts of a real picture, which is seldom as plain.
cv::Mat scene(Script &s)
{
    cv::Mat picture = plain(s, s.chance.between(60, 130));
    const cv::Size size = s.size;
    const int horizon = static_cast<int>(size.height * s.chance.between(.3, .6));
    picture.rowRange(0, horizon).setTo(cv::Scalar(s.chance.between(150, 230)));
    for (int i = 0; i < 8; i++) {
        const int width = std::max(3, static_cast<int>(size.width * s.chance.between(.03, .2)));
        const int height = std::max(3, static_cast<int>(size.height * s.chance.between(.1, .5)));
        cv::rectangle(picture,
                      cv::Rect(s.chance.whole(0, size.width - 1),
                               s.chance.whole(horizon / 2, horizon), width, height),
                      cv::Scalar(s.chance.between(10, 240)), cv::FILLED);
    }
    return picture;
}

cv::Mat day(Script &s)
{
    cv::Mat picture = scene(s);
    add_noise(picture, s.chance, s.chance.between(.5, 8));
    return as_camera(picture);
}

// Black but for three to eight street lights and what they light.
cv::Mat night(Script &s)
{
    cv::Mat picture = plain(s, s.chance.between(0, 10));
    const int lights = s.chance.whole(3, 8);
    for (int i = 0; i < lights; i++) {
        const double x0 = s.chance.between(.05, .95) * s.size.width;
        const double y0 = s.chance.between(.1, .6) * s.size.height;
        const double core = s.chance.between(.006, .012) * s.size.width;
        const double halo = s.chance.between(.02, .04) * s.size.width;
        const double glow = s.chance.between(50, 120);
        for (int y = 0; y < s.size.height; y++)
            for (int x = 0; x < s.size.width; x++) {
                const double square = (x - x0) * (x - x0) + (y - y0) * (y - y0);
                picture.at<float>(y, x) += static_cast<float>(
                    square < core * core ? 255 : glow * std::exp(-.5 * square / (halo * halo)));
            }
    }
    add_noise(picture, s.chance, s.chance.between(.5, 6));
    return as_camera(picture);
}

cv::Mat fog(Script &s)
{
    const double left = s.chance.between(.3, .5), veil = s.chance.between(150, 220);
    cv::Mat picture = scene(s);
    picture = left * picture + (1 - left) * veil;
    add_noise(picture, s.chance, s.chance.between(.5, 3));
    return as_camera(picture);
}

// Nothing but a wall, a quarter darker at one side.
cv::Mat wall(Script &s)
{
    const double level = s.chance.between(100, 220), shade = s.chance.between(.25, .5);
    const bool is_sideways = s.chance.whole(0, 1) == 1;
    cv::Mat picture = plain(s, level);
    for (int y = 0; y < s.size.height; y++)
        for (int x = 0; x < s.size.width; x++)
            picture.at<float>(y, x) -= static_cast<float>(
                level * shade *
                (is_sideways ? double(x) / s.size.width : double(y) / s.size.height));
    add_noise(picture, s.chance, s.chance.between(.5, 6));
    return as_camera(picture);
}

// White ground below a white sky, and some dark trees.
cv::Mat snow(Script &s)
{
    cv::Mat picture = plain(s, s.chance.between(220, 245));
    picture.rowRange(0, s.size.height / 2).setTo(cv::Scalar(255));
    for (int i = 0; i < 6; i++)
        cv::rectangle(picture,
                      cv::Rect(s.chance.whole(0, s.size.width - 1), s.size.height / 4,
                               std::max(2, s.size.width / 30), s.size.height / 2),
                      cv::Scalar(s.chance.between(30, 120)), cv::FILLED);
    add_noise(picture, s.chance, s.chance.between(.5, 3));
    return as_camera(picture);
}

// One half of the picture is black, a covered lens or an unlit road. Deliberately no fault: the
// other half may be all that there is to see.
cv::Mat half_black(Script &s)
{
    cv::Mat picture = scene(s);
    if (s.chance.whole(0, 1))
        picture.rowRange(s.size.height / 2, s.size.height).setTo(cv::Scalar(0));
    else
        picture.colRange(0, s.size.width / 2).setTo(cv::Scalar(0));
    add_noise(picture, s.chance, s.chance.between(.5, 6));
    return as_camera(picture);
}

using Render = cv::Mat (*)(Script &script);
struct Kind {
    const char *name;
    Render render;
    int quality_min; // of JPEG
};

// Below this quality the means of JPEG's blocks have steps larger than the least contrast.
constexpr int jpeg_min = 10;

const Kind faults[] = {{"black", black, jpeg_min},
                       {"black with noise", black_with_noise, jpeg_min},
                       {"blocky black", blocky_black, 1},
                       {"white", white, jpeg_min},
                       {"white with noise", white_with_noise, jpeg_min},
                       {"overexposed", overexposed, 60},
                       {"grey", grey, jpeg_min},
                       {"grey with noise", grey_with_noise, jpeg_min},
                       {"lens cap", lens_cap, jpeg_min},
                       {"uniform noise", uniform_noise, jpeg_min},
                       {"colour noise", colour_noise, jpeg_min},
                       {"salt and pepper", salt_and_pepper, jpeg_min}};

const Kind pictures[] = {{"day", day, 30},   {"night", night, 30}, {"fog", fog, 30},
                         {"wall", wall, 30}, {"snow", snow, 30},   {"half black", half_black, 30}};

// The verdicts on all scripts of a kind, and how near they come to the limits.
struct Tally {
    std::array<unsigned, VDNA_HEALTH_COUNT> frames{};
    uint32_t contrast_least = 255, contrast_most = 0, bright_most = 0;
    double structure_least = 1e9, structure_most = 0; // percent of grain
};

Tally judge(const Kind &kind)
{
    Camera camera;
    vdna_health health;
    assert_int_equal(vdna_health_init(&health, nullptr), VDNA_OK);
    Tally tally;
    for (unsigned seed = 1; seed <= scripts; seed++) {
        Script script = begin(seed, kind.quality_min);
        for (int i = 0; i < own_frames; i++) {
            const vdna_health_picture picture = camera.measure(kind.render(script), script);
            tally.frames[vdna_health_judge(&health, &picture)]++;
            const double structure = 100.0 * picture.structure / std::max(1u, picture.grain);
            tally.contrast_least = std::min(tally.contrast_least, picture.contrast);
            tally.contrast_most = std::max(tally.contrast_most, picture.contrast);
            tally.structure_least = std::min(tally.structure_least, structure);
            tally.structure_most = std::max(tally.structure_most, structure);
            tally.bright_most = std::max(tally.bright_most, picture.bright);
        }
    }
    std::printf("%-17s contrast %3u..%3u, structure %4.0f..%5.0f %% of grain, bright <= %4u:",
                kind.name, tally.contrast_least, tally.contrast_most, tally.structure_least,
                tally.structure_most, tally.bright_most);
    for (uint32_t verdict = 0; verdict < VDNA_HEALTH_COUNT; verdict++)
        if (tally.frames[verdict])
            std::printf(" %s %u", vdna_health_text(verdict), tally.frames[verdict]);
    std::printf("\n");
    return tally;
}

// ---- Faults of frames one after the other ----

using Feed = void (*)(Script &script, Camera &camera, vdna_health *health);

// What a robot would go by.
bool is_usable(const vdna_health &health)
{
    return vdna_health_degraded(&health) == VDNA_HEALTH_OK &&
           health.counts[VDNA_HEALTH_OK] >= distinct_min;
}

unsigned count_usable(Feed feed, int quality_min)
{
    Camera camera;
    unsigned usable = 0;
    for (unsigned seed = 1; seed <= scripts; seed++) {
        Script script = begin(seed, quality_min);
        vdna_health health;
        assert_int_equal(vdna_health_init(&health, nullptr), VDNA_OK);
        feed(script, camera, &health);
        usable += is_usable(health);
    }
    return usable;
}

void take(vdna_health *health, const vdna_health_picture &picture)
{
    vdna_health_take(health, &picture);
}

// A few pictures in turn, or in any order.
void repeat(Script &s, Camera &camera, vdna_health *health, int count)
{
    std::vector<vdna_health_picture> all;
    for (int i = 0; i < count; i++)
        all.push_back(camera.measure(day(s), s));
    const bool is_in_turn = s.chance.whole(0, 1) == 1;
    for (int i = 0; i < frames_of_many; i++)
        take(health,
             all[static_cast<size_t>(is_in_turn ? i % count : s.chance.whole(0, count - 1))]);
}

void one_for_ever(Script &s, Camera &camera, vdna_health *health)
{
    repeat(s, camera, health, 1);
}

void two_alternate(Script &s, Camera &camera, vdna_health *health)
{
    repeat(s, camera, health, 2);
}

void few_repeat(Script &s, Camera &camera, vdna_health *health)
{
    repeat(s, camera, health, s.chance.whole(3, 9));
}

void tiny(Script &s, Camera &camera, vdna_health *health)
{
    s.size = {s.chance.whole(1, 16), s.chance.whole(1, 16)};
    for (int i = 0; i < frames_of_many; i++) {
        const uint32_t verdict = VDNA_HEALTH_TOO_SMALL;
        const vdna_health_picture picture = camera.measure(colour_noise(s), s);
        assert_int_equal(vdna_health_take(health, &picture), verdict);
    }
}

void sizes_change(Script &s, Camera &camera, vdna_health *health)
{
    const int count = s.chance.whole(2, 4);
    for (int i = 0; i < frames_of_many; i++) {
        const int scale = 1 << s.chance.whole(0, count - 1);
        s.size = {64 * scale, 48 * scale};
        take(health, camera.measure(day(s), s));
    }
}

// A robot that stands still: the noise of its sensor is all that changes.
void stand_still(Script &s, Camera &camera, vdna_health *health)
{
    const cv::Mat still = scene(s);
    const double deviation = s.chance.between(.7, 6);
    for (int i = 0; i < frames_of_many; i++) {
        cv::Mat picture = still.clone();
        add_noise(picture, s.chance, deviation);
        const vdna_health_picture found = camera.measure(as_camera(picture), s);
        assert_int_equal(vdna_health_take(health, &found), VDNA_HEALTH_OK);
    }
}

void no_frame_of_a_fault_is_usable(void **state)
{
    (void)state;
    unsigned missed = 0;
    for (const Kind &fault : faults)
        missed += judge(fault).frames[VDNA_HEALTH_OK];
    assert_int_equal(missed, 0);
}

void no_picture_that_looks_like_a_fault_is_one(void **state)
{
    (void)state;
    unsigned alarms = 0;
    for (const Kind &picture : pictures)
        alarms += scripts * own_frames - judge(picture).frames[VDNA_HEALTH_OK];
    assert_int_equal(alarms, 0);
}

void one_picture_for_ever_is_of_no_use(void **state)
{
    (void)state;
    assert_int_equal(count_usable(one_for_ever, 30), 0);
}

void two_pictures_in_turn_are_of_no_use(void **state)
{
    (void)state;
    assert_int_equal(count_usable(two_alternate, 30), 0);
}

void few_pictures_again_and_again_are_of_no_use(void **state)
{
    (void)state;
    assert_int_equal(count_usable(few_repeat, 30), 0);
}

void pictures_of_16_pixels_a_side_are_of_no_use(void **state)
{
    (void)state;
    assert_int_equal(count_usable(tiny, 30), 0);
}

void sizes_that_keep_changing_are_of_no_use(void **state)
{
    (void)state;
    assert_int_equal(count_usable(sizes_change, 30), 0);
}

void a_robot_that_stands_still_is_not_frozen(void **state)
{
    (void)state;
    assert_int_equal(count_usable(stand_still, 70), scripts);
}

} // namespace

int main(int argc, char **argv)
{
    if (argc > 1)
        scripts = static_cast<unsigned>(std::strtoul(argv[1], nullptr, 10));
    const CMUnitTest tests[] = {
        cmocka_unit_test(no_frame_of_a_fault_is_usable),
        cmocka_unit_test(no_picture_that_looks_like_a_fault_is_one),
        cmocka_unit_test(one_picture_for_ever_is_of_no_use),
        cmocka_unit_test(two_pictures_in_turn_are_of_no_use),
        cmocka_unit_test(few_pictures_again_and_again_are_of_no_use),
        cmocka_unit_test(pictures_of_16_pixels_a_side_are_of_no_use),
        cmocka_unit_test(sizes_that_keep_changing_are_of_no_use),
        cmocka_unit_test(a_robot_that_stands_still_is_not_frozen),
    };
    return cmocka_run_group_tests_name("health_faults", tests, nullptr, nullptr);
}
