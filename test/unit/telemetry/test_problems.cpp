// What a status tells of problems.
#include "cmocka.hpp"
#include "telemetry/problems.hpp"

namespace
{

using vdna::telemetry::problems_of;
using Problems = std::vector<std::string>;

void where_nothing_is_wrong_there_are_none(void **)
{
    assert_true(problems_of(nullptr).empty());
    assert_true(problems_of({{"received", 9}, {"refused", 0}, {"message", ""}}).empty());
    assert_true(problems_of({{"map_changed", false}, {"lost", nullptr}, {"late", "9"}}).empty());
}

void the_last_one_comes_first_and_each_says_what_to_do_if_that_is_known(void **)
{
    const Problems expected{
        "no message on CAMERA for 3 s",
        "The map's directory has changed since it was opened; SIGHUP opens it again",
        "Frames too old: 2; let one camera only send on the channel",
        "Camera messages that never came: 7",
    };
    assert_true(problems_of({{"lost", 7},
                             {"late", 2},
                             {"map_changed", true},
                             {"message", "no message on CAMERA for 3 s"}}) == expected);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(where_nothing_is_wrong_there_are_none),
        cmocka_unit_test(the_last_one_comes_first_and_each_says_what_to_do_if_that_is_known),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
