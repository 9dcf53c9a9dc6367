#include "cmocka.hpp"
#include "eval/conditions.hpp"

using vdna::eval::conditions_of;
using Names = std::vector<std::string>;

namespace
{

void a_number_at_the_end_is_not_part_of_the_condition(void **)
{
    assert_true(conditions_of({"day1", "day2", "night_02", "night-1", "dusk", "2nd 7"}) ==
                (Names{"day", "day", "night", "night", "dusk", "2nd"}));
}

void numbered_traversals_are_conditions_of_their_own(void **)
{
    const Names months = {"month01", "month02"}, numbers = {"1", "night"}, one = {"day1"};
    assert_true(conditions_of(months) == months); // the same would be left of all
    assert_true(conditions_of(numbers) == numbers);
    assert_true(conditions_of(one) == one);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_number_at_the_end_is_not_part_of_the_condition),
        cmocka_unit_test(numbered_traversals_are_conditions_of_their_own),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
