#include <math.h>

#include "cmocka_all.h"
#include "recall_angle.h"

static void assert_close(double found, long double expected)
{
    if (fabsl(found - expected) > 2e-15L)
        fail_msg("%.17g is not %.17Lg", found, expected);
}

static void angles_are_those_of_libm_within_their_error(void **state)
{
    (void)state;
    for (int i = 0; i <= 100000; i++)
        assert_close(vdna_recall_angle(i / 1e5), asinl(sqrtl(i / 1e5)));
    for (double recall = 1e-300; recall < 0.1; recall *= 7) {
        assert_close(vdna_recall_angle(recall), asinl(sqrtl(recall)));
        assert_close(vdna_recall_angle(1 - recall), asinl(sqrtl(1 - recall)));
    }
}

static void recalls_are_those_of_libm_within_their_error(void **state)
{
    (void)state;
    for (int i = 0; i <= 157079; i++)
        assert_close(vdna_angle_recall(i / 1e5), sinl(i / 1e5) * sinl(i / 1e5));
}

static void what_lies_beyond_is_clipped(void **state)
{
    (void)state;
    assert_true(vdna_recall_angle(-1) == 0);
    assert_true(vdna_recall_angle(0) == 0);
    assert_true(vdna_recall_angle(1e-310) == 0);
    assert_true(vdna_recall_angle(1) == VDNA_HALF_PI);
    assert_true(vdna_recall_angle(2) == VDNA_HALF_PI);
    assert_true(vdna_angle_recall(-0.1) == 0);
    assert_true(vdna_angle_recall(1.6) == 1);
    assert_true(vdna_angle_recall(VDNA_HALF_PI) == 1);
}

static void the_log_of_little_is_that_of_a_millionth(void **state)
{
    (void)state;
    assert_close(vdna_ln(0), logl(1e-6));
    assert_close(vdna_ln(1e-7), logl(1e-6));
    assert_close(vdna_ln(2), logl(2));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(angles_are_those_of_libm_within_their_error),
        cmocka_unit_test(recalls_are_those_of_libm_within_their_error),
        cmocka_unit_test(what_lies_beyond_is_clipped),
        cmocka_unit_test(the_log_of_little_is_that_of_a_millionth),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
