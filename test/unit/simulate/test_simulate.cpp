// The simulated route: repeatable, the same places under every condition, forward motion, labels.
#include <csignal>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <unistd.h>

#include <vdna/cpp/error.hpp>

#include "cmocka.hpp"
#include "program/exit_code.hpp"
#include "program/interrupt.hpp"
#include "simulate/landmark.hpp"
#include "simulate/recording.hpp"

using namespace vdna;
using namespace vdna::program;
using namespace vdna::simulate;
namespace fs = std::filesystem;

static const cv::Size small(160, 120);

static Shot shot_at(const Route &route, double along)
{
    const cv::Point2d at = route.at(along);
    return {{at.x, at.y, std::atan(route.slope(along))}, 1, 0, 1};
}

static cv::Mat3b picture(const std::string &condition, double along, uint64_t seed = 7)
{
    const Route route(seed);
    return Renderer(route, find_condition(condition), small).render(shot_at(route, along));
}

// Mean difference of two pictures in grey levels.
static double difference(const cv::Mat3b &a, const cv::Mat3b &b)
{
    return cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total() * 3);
}

// The edges, independent of their colours; blurred, so that noise does not count.
static cv::Mat1f edges(const cv::Mat3b &picture)
{
    cv::Mat grey, right, down, strength;
    cv::cvtColor(picture, grey, cv::COLOR_BGR2GRAY);
    cv::GaussianBlur(grey, grey, {5, 5}, 1.2);
    cv::Sobel(grey, right, CV_32F, 1, 0);
    cv::Sobel(grey, down, CV_32F, 0, 1);
    cv::magnitude(right, down, strength);
    strength -= cv::mean(strength)[0];
    strength /= cv::norm(strength);
    return strength;
}

// A directory that is removed after the test.
class Scratch
{
  public:
    Scratch()
    {
        std::string name = (fs::temp_directory_path() / "vdna-simulate-XXXXXX").string();
        assert_non_null(mkdtemp(name.data()));
        path_ = name;
    }
    ~Scratch() { fs::remove_all(path_); }
    fs::path operator/(const char *name) const { return path_ / name; }
    size_t entries() const
    {
        return static_cast<size_t>(
            std::distance(fs::directory_iterator(path_), fs::directory_iterator()));
    }

  private:
    fs::path path_;
};

static void record(const fs::path &directory, size_t frames, bool force = false)
{
    const Route route(7);
    RecordingConfig config;
    config.size = small;
    config.frames = frames;
    config.force = force;
    record_drive(directory, route, find_condition("summer"), Drive(route, {}), config);
}

// The sentence that record() ends with, and the exit code.
static std::pair<std::string, int> refusal(const fs::path &directory, bool force = false)
{
    try {
        record(directory, 2, force);
    } catch (const Error &error) {
        return {error.what(), exit_code_of(error)};
    }
    return {"", exit_ok};
}

static void the_same_arguments_give_the_same_pixels(void **)
{
    for (const Condition &condition : conditions())
        assert_true(difference(picture(condition.name, 40), picture(condition.name, 40)) == 0);
}

static void another_place_and_another_seed_are_another_picture(void **)
{
    const cv::Mat3b here = picture("summer", 40);
    assert_true(difference(here, picture("summer", 70)) > 10);
    assert_true(difference(here, picture("summer", 40, 8)) > 10);
}

static void a_place_keeps_its_shapes_under_another_condition(void **)
{
    const double places[] = {10, 50, 90, 130};
    for (double here : places) {
        const cv::Mat1f shapes = edges(picture("summer", here));
        const double kept = shapes.dot(edges(picture("dusk", here)));
        for (double there : places)
            if (there != here)
                assert_true(kept > shapes.dot(edges(picture("dusk", there))) + .1);
    }
}

static void conditions_look_different_at_the_same_place(void **)
{
    const auto &all = conditions();
    for (size_t i = 0; i < all.size(); i++)
        for (size_t j = 0; j < i; j++)
            assert_true(difference(picture(all[i].name, 40), picture(all[j].name, 40)) > 8);
}

static void no_two_landmarks_are_alike(void **)
{
    const auto landmarks = Route(7).landmarks(0, 300);
    std::set<uint64_t> shapes;
    for (const Landmark &landmark : landmarks)
        shapes.insert(landmark.shape);
    assert_true(landmarks.size() > 100);
    assert_int_equal(shapes.size(), landmarks.size());
}

static void the_camera_projects_as_a_pinhole_a_metre_above_the_ground(void **)
{
    const Camera camera({3, 2, 0}, small); // looks along x; 128 pixels per metre at one metre
    const cv::Point2f ahead = camera.pixel(camera.see({13, 2}, 1));
    assert_true(ahead == cv::Point2f(80, 60));
    const cv::Point2f right = camera.pixel(camera.see({11, -2}, 0)); // 8 m ahead, 4 m to the right
    assert_true(right == cv::Point2f(80 + 64, 60 + 16));
    const cv::Point2d back = camera.ground(4, 8);
    assert_true(back == cv::Point2d(11, -2));
}

static void a_landmark_does_not_depend_on_where_it_is_seen_from(void **)
{
    const Route route(7);
    const auto from_here = route.landmarks(0, 60), from_there = route.landmarks(-30, 45);
    size_t shared = 0;
    for (const Landmark &a : from_here)
        for (const Landmark &b : from_there)
            shared += a.shape == b.shape && a.along == b.along && a.kind == b.kind;
    size_t expected = 0;
    for (const Landmark &a : from_here)
        expected += a.along <= 45;
    assert_true(expected > 10);
    assert_int_equal(shared, expected);
}

// Pixels that a lit street lamp paints white, around where it is expected.
static int shining_pixels(const Landmark &lamp, const Route &route, double along)
{
    const Shot shot = shot_at(route, along);
    const Camera camera(shot.pose, small);
    const cv::Point head =
        camera.pixel(camera.see(route.at(lamp.along, lamp.across), lamp_head(lamp)));
    const cv::Mat3b seen = Renderer(route, find_condition("night"), small).render(shot);
    cv::Mat1b grey;
    cv::cvtColor(seen, grey, cv::COLOR_BGR2GRAY);
    const cv::Rect around(head - cv::Point(6, 6), cv::Size(13, 13));
    return cv::countNonZero(grey(around & cv::Rect({}, small)) > 160);
}

static void a_landmark_ahead_grows_as_the_robot_moves_on(void **)
{
    const Route route(7);
    int lamps = 0;
    for (const Landmark &lamp : route.landmarks(20, 80)) {
        if (lamp.kind != Kind::lamp)
            continue;
        lamps++;
        const int far = shining_pixels(lamp, route, lamp.along - 20);
        assert_true(shining_pixels(lamp, route, lamp.along - 9) > far);
    }
    assert_true(lamps > 1);
}

static void labels_say_where_and_when_each_picture_was_taken(void **)
{
    const Scratch scratch;
    record(scratch / "drive", 3);
    const Route route(7);
    std::ifstream labels(scratch / "drive" / "labels.csv");
    std::string line;
    assert_true(bool(std::getline(labels, line)));
    assert_string_equal(line.c_str(), "file,utime,x,y");
    for (int frame = 0; frame < 3; frame++) {
        const double x = .5 * frame;
        char expected[64];
        std::snprintf(expected, sizeof expected, "%06d.jpg,%d,%.3f,%.3f", frame, 100000 * frame, x,
                      route.at(x).y);
        assert_true(bool(std::getline(labels, line)));
        assert_string_equal(line.c_str(), expected);
        // JPEG and the sensor's noise change a pixel little, another place changes it much.
        const cv::Mat3b read = cv::imread(scratch / "drive" / line.substr(0, 10));
        assert_true(read.size() == small);
        assert_true(difference(read, picture("summer", x)) < 6);
    }
    assert_false(bool(std::getline(labels, line)));
    assert_int_equal(scratch.entries(), 1);
}

static void a_drive_without_variation_keeps_to_the_line_and_the_look(void **)
{
    const Route route(7);
    const Shot first = Drive(route, {}).shot(4);
    DriveConfig other;
    other.seed = 2;
    assert_true(Drive(route, other).shot(4).pose.y == first.pose.y);
    other.variation = 1;
    assert_true(std::abs(Drive(route, other).shot(4).pose.y - first.pose.y) > .01);
    assert_true(std::abs(Drive(route, other).shot(4).pose.y - first.pose.y) < 1);

    const Condition plain = find_condition("autumn");
    assert_true(on_another_day(plain, 0, 5).litter == plain.litter);
    assert_true(on_another_day(plain, 1, 5).litter != plain.litter);
    assert_true(on_another_day(find_condition("summer"), 1, 5).snow == 0);
}

static void the_figure_of_eight_crosses_itself_at_a_right_angle_in_every_lap(void **)
{
    const Route eight(7, Shape::eight);
    for (const double along : {0., eight_length / 2, eight_length, 1.5 * eight_length})
        assert_true(cv::norm(eight.position(along, 0)) < 1e-9);
    const cv::Point2d out = eight.position(1, 0), back = eight.position(eight_length / 2 - 1, 0);
    assert_true(std::abs(out.dot(back)) < 1e-9);
    for (double along = -30; along < 2 * eight_length; along += .25) {
        const cv::Point2d here = eight.position(along, 0), next = eight.position(along + .25, 0);
        assert_true(std::abs(cv::norm(next - here) - .25) < 1e-3);
        // Left of the way ahead.
        const cv::Point2d ahead = (next - here) / .25, left = eight.position(along, 2) - here;
        assert_true(std::abs(left.dot(cv::Point2d(-ahead.y, ahead.x)) - 2) < .02);
        assert_true(cv::norm(here - eight.position(along + eight_length, 0)) < 1e-9);
    }
}

static void every_lap_of_a_closed_route_looks_like_the_first(void **)
{
    const Route eight(7, Shape::eight);
    const auto seen = [&](double along) {
        const Drive drive(eight, {along, .5, 10, 0, 1});
        return Renderer(eight, find_condition("summer"), small).render(drive.shot(0));
    };
    for (const double along : {2., 130., 250.}) {
        assert_true(difference(seen(along), seen(along + eight_length)) < 1e-3);
        assert_true(difference(seen(along), seen(along + 10)) > 8);
    }
    // Also where a lap ends: the landmarks ahead are those of its beginning.
    const auto ahead = eight.landmarks(eight_length - 10, eight_length + 60),
               first = eight.landmarks(-10, 60);
    assert_true(first.size() > 20);
    assert_int_equal(ahead.size(), first.size());
    for (size_t i = 0; i < first.size(); i++) {
        assert_true(ahead[i].shape == first[i].shape);
        assert_true(std::abs(ahead[i].along - eight_length - first[i].along) < 1e-4);
    }
    const cv::Point2d end = eight.at(eight_length + 5), begin = eight.at(5);
    assert_true(std::abs(end.y - begin.y) < 1e-9);
}

static void an_unknown_condition_is_refused_with_the_known_ones(void **)
{
    try {
        find_condition("monsoon");
        fail();
    } catch (const Error &error) {
        assert_string_equal(error.what(), "there is no condition 'monsoon'; known ones: spring, "
                                          "summer, autumn, winter, overcast, rain, dusk, night");
        assert_int_equal(exit_code_of(error), exit_usage);
    }
}

static void a_directory_in_use_is_not_overwritten(void **)
{
    const Scratch scratch;
    record(scratch / "drive", 3);
    assert_non_null(std::strstr(refusal(scratch / "drive").first.c_str(), "give --force"));
    assert_true(fs::exists(scratch / "drive" / "000002.jpg"));

    record(scratch / "drive", 1, true);
    assert_false(fs::exists(scratch / "drive" / "000002.jpg"));

    std::ofstream(scratch / "drive" / "thesis.tex") << "precious";
    assert_non_null(std::strstr(refusal(scratch / "drive", true).first.c_str(),
                                "thesis.tex: is not part of a recording"));
    assert_true(fs::exists(scratch / "drive" / "thesis.tex"));
    assert_int_equal(scratch.entries(), 1);
}

static void a_sheet_has_a_row_for_each_condition_and_a_known_format(void **)
{
    const Scratch scratch;
    write_sheet(scratch / "sheet.png", Route(7), {}, small, 2, 90);
    const cv::Mat sheet = cv::imread(scratch / "sheet.png");
    assert_int_equal(sheet.cols, 2 * small.width);
    assert_int_equal(sheet.rows, static_cast<int>(conditions().size()) * small.height);
    try {
        write_sheet(scratch / "sheet.doc", Route(7), {}, small, 2, 90);
        fail();
    } catch (const Error &error) {
        assert_non_null(std::strstr(error.what(), "sheet.doc: no picture format"));
    }
    assert_int_equal(scratch.entries(), 1);
}

// Last, because a signal is never forgotten.
static void an_interrupted_drive_leaves_nothing_behind(void **)
{
    const Scratch scratch;
    catch_interrupts();
    std::raise(SIGTERM);
    assert_int_equal(refusal(scratch / "drive").second, exit_interrupted);
    assert_int_equal(scratch.entries(), 0);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_same_arguments_give_the_same_pixels),
        cmocka_unit_test(another_place_and_another_seed_are_another_picture),
        cmocka_unit_test(a_place_keeps_its_shapes_under_another_condition),
        cmocka_unit_test(conditions_look_different_at_the_same_place),
        cmocka_unit_test(no_two_landmarks_are_alike),
        cmocka_unit_test(the_camera_projects_as_a_pinhole_a_metre_above_the_ground),
        cmocka_unit_test(a_landmark_does_not_depend_on_where_it_is_seen_from),
        cmocka_unit_test(a_landmark_ahead_grows_as_the_robot_moves_on),
        cmocka_unit_test(labels_say_where_and_when_each_picture_was_taken),
        cmocka_unit_test(a_drive_without_variation_keeps_to_the_line_and_the_look),
        cmocka_unit_test(the_figure_of_eight_crosses_itself_at_a_right_angle_in_every_lap),
        cmocka_unit_test(every_lap_of_a_closed_route_looks_like_the_first),
        cmocka_unit_test(an_unknown_condition_is_refused_with_the_known_ones),
        cmocka_unit_test(a_directory_in_use_is_not_overwritten),
        cmocka_unit_test(a_sheet_has_a_row_for_each_condition_and_a_known_format),
        cmocka_unit_test(an_interrupted_drive_leaves_nothing_behind),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
