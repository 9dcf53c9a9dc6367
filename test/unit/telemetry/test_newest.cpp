// The newest messages of a daemon, of several on the same channels.
#include <cmath>

#include "cmocka.hpp"
#include "telemetry/newest.hpp"

namespace
{

using vdna::telemetry::Newest;
using Json = Newest::Json;

constexpr int64_t second_us = 1000000;

bool take(Newest &newest, const Json &status, int64_t now_us)
{
    return newest.take("status", status, now_us);
}

// A status of daemon `instance`, sent after so many seconds.
Json status_of(int instance, const char *state, int second, int received)
{
    return {{"utime", 1700000000000000 + second * second_us},
            {"instance", instance},
            {"state", state},
            {"received", received}};
}

void it_knows_nothing_before_the_first_status(void **)
{
    const Newest newest(2 * second_us);
    assert_true(newest.status().is_null() && newest.ranking().is_null());
    assert_int_equal(newest.status_us(), 0);
    assert_true(newest.silent_s(5 * second_us) == 3);
    assert_true(std::isnan(newest.camera_hz()));
}

void the_rate_is_that_of_the_daemons_counter_over_three_seconds(void **)
{
    Newest newest(0);
    const int received[] = {1000, 1000, 1010, 1030, 1060};
    for (int i = 0; i < 5; i++)
        take(newest, status_of(1, "VALID", i, received[i]), (i + 1) * second_us);
    assert_true(newest.camera_hz() == 20);
    assert_true(newest.silent_s(6 * second_us) == 1);
    take(newest, status_of(2, "VALID", 9, 5), 6 * second_us); // counts anew
    assert_true(std::isnan(newest.camera_hz()));
}

void a_restarted_daemon_that_warms_up_has_no_choice(void **)
{
    Newest newest(0);
    take(newest, status_of(1, "VALID", 0, 9), second_us);
    newest.take("ranking", {{"margin_bins", 1.5}}, second_us);
    newest.take("localisation", {{"frame", 7}}, second_us);
    take(newest, status_of(1, "WARMUP", 1, 9), 2 * second_us); // a reset
    assert_true(newest.ranking()["margin_bins"] == 1.5 && newest.localisation()["frame"] == 7);
    take(newest, status_of(2, "WARMUP", 2, 0), 3 * second_us);
    assert_true(newest.ranking().is_null() && newest.localisation().is_null());
}

void one_that_stands_by_is_passed_over_while_another_answers(void **)
{
    Newest newest(0);
    const Json standby = status_of(2, "STANDBY", 0, 0);
    assert_true(take(newest, standby, second_us)); // nobody else yet
    assert_true(take(newest, status_of(1, "VALID", 0, 9), second_us));
    assert_false(take(newest, standby, 2 * second_us));
    assert_true(newest.status()["instance"] == 1);
    assert_true(take(newest, standby, 9 * second_us)); // the other is gone
    assert_false(newest.take("heartbeat", standby, 9 * second_us));
}

void what_cannot_be_read_is_named(void **)
{
    Newest newest(0);
    assert_string_equal(newest.rejected().c_str(), "");
    newest.note_rejected("VDNA_STATUS", "of another type");
    assert_string_equal(newest.rejected().c_str(), "VDNA_STATUS: of another type");
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(it_knows_nothing_before_the_first_status),
        cmocka_unit_test(the_rate_is_that_of_the_daemons_counter_over_three_seconds),
        cmocka_unit_test(a_restarted_daemon_that_warms_up_has_no_choice),
        cmocka_unit_test(one_that_stands_by_is_passed_over_while_another_answers),
        cmocka_unit_test(what_cannot_be_read_is_named),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
