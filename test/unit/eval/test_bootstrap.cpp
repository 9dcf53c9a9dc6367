#include <cmath>

#include "cmocka.hpp"
#include "eval/bootstrap.hpp"

using vdna::eval::Mean;
using vdna::eval::mean_with_interval;
using vdna::eval::quantile;

namespace
{

void the_interval_is_that_of_numpy(void **)
{
    // python3 -c 'import numpy as np; v = np.array([1., 2., 4., 8., 16.])
    // i = np.random.RandomState(1).randint(0, 2**32, (2000, 5), dtype=np.uint32) % 5
    // print(np.quantile(v[i].mean(axis=1), [.025, .975]))'
    const Mean mean = mean_with_interval({1, 2, 4, 8, 16});
    assert_true(mean.value == 6.2);
    assert_true(std::fabs(mean.low - 2) < 1e-12);
    assert_true(std::fabs(mean.high - 11.4) < 1e-12);
}

void equal_values_have_an_interval_of_no_width(void **)
{
    const Mean mean = mean_with_interval({50, 50, 50});
    assert_true(mean.value == 50 && mean.low == 50 && mean.high == 50);
}

void one_value_has_no_interval_and_no_value_has_no_mean(void **)
{
    const Mean one = mean_with_interval({3}), none = mean_with_interval({});
    assert_true(one.value == 3 && std::isnan(one.low) && std::isnan(one.high));
    assert_true(std::isnan(none.value) && std::isnan(none.low));
}

void the_outermost_quantiles_are_the_ends(void **)
{
    assert_true(quantile({1, 2, 4}, 0) == 1 && quantile({1, 2, 4}, 1) == 4);
    assert_true(quantile({1, 2, 4}, 0.75) == 3);
    assert_true(quantile({7}, 0.5) == 7 && quantile({7}, 1) == 7);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_interval_is_that_of_numpy),
        cmocka_unit_test(equal_values_have_an_interval_of_no_width),
        cmocka_unit_test(the_outermost_quantiles_are_the_ends),
        cmocka_unit_test(one_value_has_no_interval_and_no_value_has_no_mean),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
