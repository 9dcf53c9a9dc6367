// The text of the progress bar.

#include "cmocka.hpp"
#include "program/progress.hpp"

static void the_bar_tells_share_rate_and_time_left(void **)
{
    assert_string_equal(vdna::program::progress_line("winter", 30, 120, 2.0).c_str(),
                        "winter [#####---------------]  30/120  15/s  6 s left");
}

static void slow_work_is_told_in_minutes_and_tenths(void **)
{
    assert_string_equal(vdna::program::progress_line("map", 1, 100, 2.0).c_str(),
                        "map [--------------------]  1/100  0.5/s  3:18 min left");
}

static void nothing_done_yet_promises_nothing(void **)
{
    assert_string_equal(vdna::program::progress_line("map", 0, 4, 3.0).c_str(),
                        "map [--------------------]  0/4");
}

static void more_steps_than_announced_stay_at_the_end(void **)
{
    assert_string_equal(vdna::program::progress_line("map", 9, 4, 4.0).c_str(),
                        "map [####################]  4/4  1.0/s  0 s left");
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_bar_tells_share_rate_and_time_left),
        cmocka_unit_test(slow_work_is_told_in_minutes_and_tenths),
        cmocka_unit_test(nothing_done_yet_promises_nothing),
        cmocka_unit_test(more_steps_than_announced_stay_at_the_end),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
