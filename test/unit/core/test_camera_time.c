#include <vdna/camera_time.h>

#include "cmocka_all.h"

#define T0 INT64_C(1700000000000000) /* microseconds since 1970 */

static uint32_t take(vdna_camera_time *time, int64_t stamp)
{
    int64_t utime;
    return vdna_camera_time_take(time, stamp, &utime);
}

static vdna_camera_time axis(int64_t late_us)
{
    vdna_camera_time time;
    vdna_camera_time_init(&time, VDNA_TIME_UNIT_AUTO, late_us);
    return time;
}

/* Feed stamps first, first + step, ...; returns the last frame's microseconds. */
static int64_t feed(vdna_camera_time *time, int64_t first, int64_t step, int frames)
{
    int64_t utime = 0;
    for (int i = 0; i < frames; i++)
        assert_int_not_equal(vdna_camera_time_take(time, first + i * step, &utime), VDNA_TIME_LATE);
    return utime;
}

static void stamps_in_order_are_taken_as_they_are(void **state)
{
    (void)state;
    vdna_camera_time time = axis(VDNA_TIME_LATE_US_DEFAULT);
    assert_true(feed(&time, T0, 33333, 100) == T0 + 99 * 33333);
    assert_int_equal(time.unit, VDNA_TIME_UNIT_US);
    assert_int_equal(time.frames, 100);
    assert_int_equal(time.late + time.backwards + time.still, 0);
}

static void the_unit_is_recognised_by_size_or_spacing(void **state)
{
    (void)state;
    const struct {
        int64_t first, step;
        uint32_t unit;
    } cases[] = {
        {T0 * 1000, 33333333, VDNA_TIME_UNIT_NS},
        {T0, 33333, VDNA_TIME_UNIT_US},
        {T0 / 1000, 33, VDNA_TIME_UNIT_MS},
        {T0 / 1000000, 1, VDNA_TIME_UNIT_S},
        {0, 100000, VDNA_TIME_UNIT_US},
        {0, 100, VDNA_TIME_UNIT_MS},
        {5000, 1, VDNA_TIME_UNIT_S},
        {5000, 33, VDNA_TIME_UNIT_MS},
        {T0 / 1000000, 5, VDNA_TIME_UNIT_S},
        {T0 / 1000, 2, VDNA_TIME_UNIT_MS},
        {T0 / 1000, 33333, VDNA_TIME_UNIT_US},
        {-1000000, 40000, VDNA_TIME_UNIT_US},
        {7, 0, VDNA_TIME_UNIT_AUTO},
        {0, 0, VDNA_TIME_UNIT_AUTO},
        {T0 * 1000, 0, VDNA_TIME_UNIT_NS},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        vdna_camera_time time = axis(0);
        feed(&time, cases[i].first, cases[i].step, 20);
        assert_int_equal(time.unit, cases[i].unit);
    }
}

static void whole_seconds_repeated_by_many_frames_are_seconds(void **state)
{
    (void)state;
    vdna_camera_time time = axis(VDNA_TIME_LATE_US_DEFAULT);
    uint32_t recognised = 0;
    int64_t utime = 0;
    for (int i = 0; i < 90; i++)
        recognised +=
            vdna_camera_time_take(&time, T0 / 1000000 + i / 30, &utime) == VDNA_TIME_RECOGNISED;
    assert_int_equal(recognised, 1);
    assert_int_equal(time.unit, VDNA_TIME_UNIT_S);
    assert_true(utime == T0 + 2000000);
}

static void another_unit_is_announced_once_and_nanoseconds_at_once(void **state)
{
    (void)state;
    vdna_camera_time time = axis(0);
    int64_t utime;
    assert_int_equal(vdna_camera_time_take(&time, T0 * 1000 + 999, &utime), VDNA_TIME_IN_ORDER);
    assert_true(utime == T0);

    time = axis(0);
    for (int i = 0; i < 8; i++)
        assert_int_equal(take(&time, 100 * i), VDNA_TIME_IN_ORDER);
    assert_int_equal(take(&time, 800), VDNA_TIME_RECOGNISED);
    assert_true(time.newest_us == 800000);
    assert_int_equal(take(&time, 900), VDNA_TIME_IN_ORDER);
}

static void a_unit_that_is_given_is_not_recognised(void **state)
{
    (void)state;
    vdna_camera_time time;
    vdna_camera_time_init(&time, VDNA_TIME_UNIT_US, 0);
    feed(&time, 0, 1, 50);
    assert_int_equal(time.unit, VDNA_TIME_UNIT_US);
    assert_true(time.newest_us == 49);
}

static void a_frame_within_the_bound_is_late_and_an_older_one_a_step_back(void **state)
{
    (void)state;
    vdna_camera_time time = axis(1000);
    take(&time, T0);
    take(&time, T0 + 100);
    assert_int_equal(take(&time, T0 + 99), VDNA_TIME_LATE);
    assert_int_equal(take(&time, T0 - 900), VDNA_TIME_LATE);
    assert_true(time.newest_us == T0 + 100);
    assert_int_equal(take(&time, T0 - 901), VDNA_TIME_BACKWARDS);
    assert_true(time.newest_us == T0 - 901);
    assert_int_equal(time.late, 2);
    assert_int_equal(time.backwards, 1);
}

static void two_frames_that_changed_places_are_late_at_any_period(void **state)
{
    (void)state;
    /* A frame each 10 s, and a bound of 1 s. */
    vdna_camera_time time = axis(VDNA_TIME_LATE_US_DEFAULT);
    take(&time, T0);
    take(&time, T0 + 20000000);
    assert_int_equal(take(&time, T0 + 10000000), VDNA_TIME_LATE);
    assert_int_equal(take(&time, T0 + 30000000), VDNA_TIME_IN_ORDER);
    assert_int_equal(take(&time, T0 + 10000000), VDNA_TIME_BACKWARDS);
}

static void frames_that_do_not_move_camera_time_are_counted(void **state)
{
    (void)state;
    vdna_camera_time time = axis(0);
    for (int i = 0; i < 5; i++)
        assert_int_equal(take(&time, 0), VDNA_TIME_IN_ORDER);
    assert_int_equal(time.still, 4);
    take(&time, 5000);
    assert_int_equal(time.still, 0);
}

static void an_axis_that_begins_anew_takes_any_stamp(void **state)
{
    (void)state;
    vdna_camera_time time = axis(0);
    feed(&time, T0, 1000, 3);
    vdna_camera_time_begin(&time);
    assert_int_equal(take(&time, T0 - 1000000), VDNA_TIME_IN_ORDER);
    assert_int_equal(time.backwards, 0);
    vdna_camera_time_begin(NULL);
    vdna_camera_time_init(NULL, 0, 0);
}

static void the_furthest_stamps_saturate(void **state)
{
    (void)state;
    assert_true(vdna_time_us(VDNA_TIME_UNIT_S, INT64_MAX) == INT64_MAX);
    assert_true(vdna_time_us(VDNA_TIME_UNIT_S, INT64_MIN) == INT64_MIN);
    assert_true(vdna_time_us(VDNA_TIME_UNIT_MS, INT64_MAX / 1000) == INT64_MAX / 1000 * 1000);
    assert_true(vdna_time_us(VDNA_TIME_UNIT_MS, INT64_MIN + 1) == INT64_MIN);
    vdna_camera_time time = axis(INT64_MAX);
    take(&time, INT64_MIN);
    assert_int_equal(take(&time, INT64_MAX), VDNA_TIME_IN_ORDER);
    assert_int_equal(take(&time, INT64_MIN), VDNA_TIME_LATE); /* as old as the frame before */
}

static void the_unit_of_a_list_is_that_of_its_median_spacing(void **state)
{
    (void)state;
    /* In any order, with stamps that repeat, and one spacing far off. */
    const int64_t jumbled[] = {9000, 8900, 8900, 8967, 9033, 9999999, 10000032, 10000065};
    assert_int_equal(vdna_time_unit(jumbled, 8), VDNA_TIME_UNIT_MS);
    /* Beyond the first spacings nothing counts. */
    int64_t long_list[20];
    for (int64_t i = 0; i < 20; i++)
        long_list[i] = i < 9 ? 40 * i : 1000000 * i;
    assert_int_equal(vdna_time_unit(long_list, 20), VDNA_TIME_UNIT_MS);
    const int64_t far_ms[] = {INT64_C(5000000000000), INT64_C(5000000000002)};
    const int64_t far_s[] = {INT64_C(5000000000), INT64_C(5000000033)};
    assert_int_equal(vdna_time_unit(far_ms, 2), VDNA_TIME_UNIT_S);
    assert_int_equal(vdna_time_unit(far_s, 2), VDNA_TIME_UNIT_MS);
    assert_int_equal(vdna_time_unit(far_s, 0), VDNA_TIME_UNIT_AUTO);
}

static void late_frames_do_not_keep_the_unit_from_being_recognised(void **state)
{
    (void)state;
    /* Every other frame is late, so that more stamps differ than frames are in order. */
    vdna_camera_time time = axis(50);
    for (int i = 0; i < 20; i++)
        take(&time, 5000 + 100 * (i / 2) - (i % 2 ? 40 : 0));
    assert_int_equal(time.unit, VDNA_TIME_UNIT_MS);
}

static void a_unit_that_is_none_is_recognised(void **state)
{
    (void)state;
    vdna_camera_time time;
    vdna_camera_time_init(&time, VDNA_TIME_UNIT_S + 1, -5);
    assert_int_equal(time.unit, VDNA_TIME_UNIT_AUTO);
    assert_int_equal(time.late_us, 0);
}

static void every_unit_has_a_name(void **state)
{
    (void)state;
    assert_string_equal(vdna_time_unit_name(VDNA_TIME_UNIT_NS), "nanoseconds");
    assert_string_equal(vdna_time_unit_name(VDNA_TIME_UNIT_S), "seconds");
    assert_string_equal(vdna_time_unit_name(77), "unknown unit");
    assert_int_equal(vdna_time_unit(NULL, 3), VDNA_TIME_UNIT_AUTO);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stamps_in_order_are_taken_as_they_are),
        cmocka_unit_test(the_unit_is_recognised_by_size_or_spacing),
        cmocka_unit_test(whole_seconds_repeated_by_many_frames_are_seconds),
        cmocka_unit_test(another_unit_is_announced_once_and_nanoseconds_at_once),
        cmocka_unit_test(a_unit_that_is_given_is_not_recognised),
        cmocka_unit_test(a_frame_within_the_bound_is_late_and_an_older_one_a_step_back),
        cmocka_unit_test(two_frames_that_changed_places_are_late_at_any_period),
        cmocka_unit_test(frames_that_do_not_move_camera_time_are_counted),
        cmocka_unit_test(an_axis_that_begins_anew_takes_any_stamp),
        cmocka_unit_test(the_furthest_stamps_saturate),
        cmocka_unit_test(the_unit_of_a_list_is_that_of_its_median_spacing),
        cmocka_unit_test(late_frames_do_not_keep_the_unit_from_being_recognised),
        cmocka_unit_test(a_unit_that_is_none_is_recognised),
        cmocka_unit_test(every_unit_has_a_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
