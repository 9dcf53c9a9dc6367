#include <set>

#include "cmocka.hpp"
#include "eval/subsets.hpp"

using vdna::eval::subsets_of;
using Subsets = std::vector<std::vector<uint32_t>>;

namespace
{

void few_choices_are_all_made(void **)
{
    std::mt19937 random(1);
    assert_true(subsets_of(4, 3, 4, random) ==
                (Subsets{{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}}));
    assert_true(subsets_of(2, 2, 1, random) == (Subsets{{0, 1}}));
}

void of_many_as_many_as_wanted_are_drawn_and_differ(void **)
{
    std::mt19937 random(1), same(1), other(2);
    const Subsets drawn = subsets_of(5, 3, 9, random); // of 10
    assert_int_equal(drawn.size(), 9);
    assert_int_equal(std::set(drawn.begin(), drawn.end()).size(), 9);
    for (const std::vector<uint32_t> &subset : drawn)
        assert_true(subset.size() == 3 && subset[0] < subset[1] && subset[1] < subset[2] &&
                    subset[2] < 5);
    assert_true(subsets_of(5, 3, 9, same) == drawn);
    assert_false(subsets_of(20, 3, 9, other) == subsets_of(20, 3, 9, same));
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(few_choices_are_all_made),
        cmocka_unit_test(of_many_as_many_as_wanted_are_drawn_and_differ),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
