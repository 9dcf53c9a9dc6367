#include <math.h>

#include "cmocka_all.h"
#include "elementary.h"

static void assert_close(double found, double expected)
{
    if (fabs(found - expected) > 1e-15 * fabs(expected))
        fail_msg("%.17g is not %.17g", found, expected);
}

static void exp_is_that_of_libm_within_its_error(void **state)
{
    (void)state;
    for (int i = -708000; i <= 708000; i += 37)
        assert_close(vdna_exp(i / 1000.0), exp(i / 1000.0));
    for (int i = -1000; i <= 1000; i++)
        assert_close(vdna_exp(i * 1e-9), exp(i * 1e-9));
}

static void exp_beyond_normal_numbers_stays_at_the_last(void **state)
{
    (void)state;
    assert_true(vdna_exp(-1e300) == vdna_exp(-708));
    assert_true(vdna_exp(-708) > 0);
    assert_true(vdna_exp(1e300) == vdna_exp(708));
    assert_true(isfinite(vdna_exp(708)));
}

static void log_is_that_of_libm_within_its_error(void **state)
{
    (void)state;
    for (double x = 1e-300; x < 1e300; x *= 1.37)
        assert_close(vdna_log(x), log(x));
    for (int i = -1000; i <= 1000; i++)
        if (i != 0)
            assert_close(vdna_log(1 + i * 1e-4), log(1 + i * 1e-4));
    assert_true(vdna_log(1) == 0);
}

static void sqrt_is_that_of_libm_within_its_error(void **state)
{
    (void)state;
    for (double x = 1e-300; x < 1e300; x *= 1.37)
        assert_close(vdna_sqrt(x), sqrt(x));
    assert_true(vdna_sqrt(0) == 0);
    assert_true(vdna_sqrt(4) == 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exp_is_that_of_libm_within_its_error),
        cmocka_unit_test(exp_beyond_normal_numbers_stays_at_the_last),
        cmocka_unit_test(log_is_that_of_libm_within_its_error),
        cmocka_unit_test(sqrt_is_that_of_libm_within_its_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
