// Which of two or three daemons serves, by what they hear of each other.
#include <cstring>
#include <string>
#include <vector>

#include "cmocka.hpp"
#include "selectord/standby.hpp"

using vdna::selectord::Standby;

namespace
{

constexpr int64_t second = 1000000;

vdna_transport_peer peer(int64_t instance, int64_t serving_utime, int64_t received_us)
{
    vdna_transport_peer heard{};
    heard.instance = instance;
    heard.serving_utime = serving_utime;
    heard.received_us = received_us;
    std::strcpy(heard.host, "robot");
    return heard;
}

bool judge(Standby &daemon, const std::vector<vdna_transport_peer> &heard, int64_t now_us)
{
    return daemon.judge(heard.data(), static_cast<uint32_t>(heard.size()), now_us,
                        100 * second + now_us);
}

void alone_it_serves(void **)
{
    Standby daemon(7, 1000);
    assert_false(judge(daemon, {}, second));
    assert_false(judge(daemon, {peer(7, 1, second)}, second)); // its own status
    assert_false(daemon.stands_by());
    assert_int_equal(daemon.serving_utime(), 1000);
    assert_string_equal(daemon.reason(), "");
}

void the_later_one_stands_by_and_names_the_other(void **)
{
    Standby later(7, 1000);
    assert_true(judge(later, {peer(8, 999, second)}, second));
    assert_true(later.stands_by());
    assert_int_equal(later.serving_utime(), 0);
    assert_non_null(std::strstr(later.reason(), "robot (instance 8)"));
    Standby earlier(8, 999);
    assert_false(judge(earlier, {peer(7, 1000, second)}, second));
    assert_false(earlier.stands_by());
}

void of_two_that_began_together_the_smaller_instance_serves(void **)
{
    Standby small(-7, 1000), large(7, 1000);
    assert_false(judge(small, {peer(7, 1000, second)}, second));
    assert_true(judge(large, {peer(-7, 1000, second)}, second));
}

void one_that_stands_by_takes_over_three_seconds_after_the_other_fell_silent(void **)
{
    Standby daemon(7, 1000);
    judge(daemon, {peer(8, 999, second)}, second);
    assert_false(judge(daemon, {peer(8, 999, second)}, 4 * second - 1));
    assert_true(judge(daemon, {peer(8, 999, second)}, 4 * second));
    assert_int_equal(daemon.serving_utime(), 104 * second);
    assert_string_equal(daemon.reason(), "");
}

void one_that_stands_by_follows_whoever_serves_however_late_that_began(void **)
{
    Standby daemon(7, 1000);
    judge(daemon, {peer(8, 999, second)}, second);
    assert_false(judge(daemon, {peer(8, 999, second), peer(9, 5000, 5 * second)}, 5 * second));
    assert_non_null(std::strstr(daemon.reason(), "instance 9"));
}

void one_that_stands_by_holds_nobody_up(void **)
{
    Standby daemon(9, 1000);
    assert_false(judge(daemon, {peer(7, 0, second), peer(8, 0, second)}, second));
    assert_false(daemon.stands_by());
    assert_false(daemon.has_newcomer());
}

void a_newcomer_is_told_once(void **)
{
    Standby daemon(7, 1000);
    judge(daemon, {peer(7, 1000, second)}, second);
    assert_false(daemon.has_newcomer());
    judge(daemon, {peer(8, 2000, second)}, second);
    assert_true(daemon.has_newcomer());
    judge(daemon, {peer(8, 2000, 2 * second)}, 2 * second);
    assert_false(daemon.has_newcomer());
}

// Two that stand by take over in the same moment, and hear each other then.
void of_two_that_take_over_one_stands_by_again(void **)
{
    Standby a(7, 1000), b(8, 1001);
    const std::vector<vdna_transport_peer> gone{peer(9, 1, 0)};
    judge(a, gone, 1);
    judge(b, gone, 2);
    assert_true(a.stands_by() && b.stands_by());
    assert_true(judge(a, gone, 3 * second));
    assert_true(judge(b, gone, 3 * second + 1));
    assert_false(judge(a, {peer(8, b.serving_utime(), 4 * second)}, 4 * second));
    assert_true(judge(b, {peer(7, a.serving_utime(), 4 * second)}, 4 * second));
    assert_true(!a.stands_by() && b.stands_by());
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(alone_it_serves),
        cmocka_unit_test(the_later_one_stands_by_and_names_the_other),
        cmocka_unit_test(of_two_that_began_together_the_smaller_instance_serves),
        cmocka_unit_test(one_that_stands_by_takes_over_three_seconds_after_the_other_fell_silent),
        cmocka_unit_test(one_that_stands_by_follows_whoever_serves_however_late_that_began),
        cmocka_unit_test(one_that_stands_by_holds_nobody_up),
        cmocka_unit_test(a_newcomer_is_told_once),
        cmocka_unit_test(of_two_that_take_over_one_stands_by_again),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
