// The rate of frames, and the way between two of them.
#include <vector>

#include "cmocka.hpp"
#include "selectord/pace.hpp"

using vdna::selectord::RateLimit;
using vdna::selectord::Stride;

namespace
{

constexpr int64_t second_us = 1000000;

// Frames taken of a camera of `hz` in ten seconds.
int taken(RateLimit &limit, int hz, int64_t jitter_us = 0)
{
    int count = 0;
    for (int i = 0; i < 10 * hz; i++)
        count += limit.takes(i * second_us / hz + (i % 2 ? jitter_us : 0));
    return count;
}

void without_a_limit_every_frame_is_taken(void **)
{
    RateLimit limit(0);
    assert_int_equal(taken(limit, 30), 300);
}

void a_limit_holds_whatever_the_cameras_rate(void **)
{
    for (const int hz : {11, 12, 15, 30, 60, 1000}) {
        RateLimit limit(10);
        assert_in_range(taken(limit, hz), 99, 102);
    }
}

void a_slower_camera_loses_no_frame(void **)
{
    for (const int64_t jitter_us : {0, 8000, -8000}) {
        RateLimit limit(10);
        assert_int_equal(taken(limit, 9, jitter_us), 90);
    }
}

void after_a_pause_at_most_one_frame_is_early(void **)
{
    RateLimit limit(10);
    assert_true(limit.takes(0));
    int count = 0;
    for (int i = 0; i < 100; i++)
        count += limit.takes(60 * second_us + i * 1000);
    assert_in_range(count, 1, 2);
}

void time_that_steps_back_begins_anew(void **)
{
    RateLimit limit(10);
    assert_true(limit.takes(1000 * second_us));
    assert_true(limit.takes(0));
    assert_false(limit.takes(10000));
}

// A map with a frame each half metre along x; without positions or places if asked.
class Road
{
  public:
    Road()
    {
        for (int i = 0; i < 1000; i++) {
            positions_.insert(positions_.end(), {0.5 * i, 0, 0});
            places_.push_back(10 * i);
        }
        map.frame_position = positions_.data();
        map.frame_place = places_.data();
    }

    vdna_experience map{};

  private:
    std::vector<double> positions_;
    std::vector<int64_t> places_;
};

// Drive at so many frames of the map a second, with all answers, for five seconds.
void drive(Stride &stride, const Road &road, int frames_a_second)
{
    for (int i = 0; i <= 50; i++)
        stride.note(road.map, 0, static_cast<uint32_t>(i * frames_a_second / 10),
                    i * second_us / 10);
}

void nothing_is_near_by_default(void **)
{
    const Road road;
    Stride stride(0);
    drive(stride, road, 4);
    assert_false(stride.is_near(5 * second_us + 1));
}

void near_ends_where_the_speed_says_so(void **)
{
    const Road road;
    Stride stride(1);
    drive(stride, road, 4); // 2 m/s
    assert_true(stride.is_near(5 * second_us + 490000));
    assert_false(stride.is_near(5 * second_us + 510000));
}

void without_positions_places_count_and_then_frames(void **)
{
    Road places;
    places.map.frame_position = nullptr;
    Stride of_places(10);
    drive(of_places, places, 4); // 40 places a second
    assert_true(of_places.is_near(5 * second_us + 240000));
    assert_false(of_places.is_near(5 * second_us + 260000));

    Road frames;
    frames.map.frame_position = nullptr;
    frames.map.frame_place = nullptr;
    Stride of_frames(1);
    drive(of_frames, frames, 4);
    assert_true(of_frames.is_near(5 * second_us + 240000));
    assert_false(of_frames.is_near(5 * second_us + 260000));
}

void at_the_latest_after_a_second_nothing_is_near(void **)
{
    const Road road;
    Stride stride(1000);
    drive(stride, road, 4);
    assert_true(stride.is_near(5 * second_us + 999999));
    assert_false(stride.is_near(6 * second_us));
}

void a_robot_that_stands_is_not_near(void **)
{
    const Road road;
    Stride stride(1);
    drive(stride, road, 0);
    assert_false(stride.is_near(5 * second_us + 1));
}

void another_experience_or_time_that_steps_back_has_no_speed(void **)
{
    const Road road;
    Stride other(1), back(1), lost(1);
    for (Stride *stride : {&other, &back, &lost})
        drive(*stride, road, 4);
    other.note(road.map, 1, 20, 5 * second_us + 1);
    back.note(road.map, 0, 20, second_us);
    lost.forget();
    assert_false(other.is_near(5 * second_us + 2));
    assert_false(back.is_near(second_us + 1));
    assert_false(lost.is_near(5 * second_us + 1));
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(without_a_limit_every_frame_is_taken),
        cmocka_unit_test(a_limit_holds_whatever_the_cameras_rate),
        cmocka_unit_test(a_slower_camera_loses_no_frame),
        cmocka_unit_test(after_a_pause_at_most_one_frame_is_early),
        cmocka_unit_test(time_that_steps_back_begins_anew),
        cmocka_unit_test(nothing_is_near_by_default),
        cmocka_unit_test(near_ends_where_the_speed_says_so),
        cmocka_unit_test(without_positions_places_count_and_then_frames),
        cmocka_unit_test(at_the_latest_after_a_second_nothing_is_near),
        cmocka_unit_test(a_robot_that_stands_is_not_near),
        cmocka_unit_test(another_experience_or_time_that_steps_back_has_no_speed),
    };
    return cmocka_run_group_tests_name("pace", tests, nullptr, nullptr);
}
