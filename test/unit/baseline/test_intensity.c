#include <math.h>

#include <vdna/baseline.h>

#include "cmocka_all.h"

static void the_distance_is_between_the_mean_levels(void **state)
{
    (void)state;
    const float dark[] = {10, 20}, bright[] = {100, 110, 120};
    double distance;
    assert_int_equal(vdna_intensity(dark, 2, bright, 3, &distance), VDNA_OK);
    assert_true(distance == 95);
    assert_int_equal(vdna_intensity(bright, 3, dark, 2, &distance), VDNA_OK);
    assert_true(distance == 95);
}

static void bad_input_is_refused(void **state)
{
    (void)state;
    const float good[] = {1}, bad[] = {NAN};
    double distance = -1;
    assert_int_equal(vdna_intensity(good, 0, good, 1, &distance), VDNA_ERR_ARG);
    assert_int_equal(vdna_intensity(NULL, 1, good, 1, &distance), VDNA_ERR_ARG);
    assert_int_equal(vdna_intensity(good, 1, good, 1, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_intensity(good, 1, bad, 1, &distance), VDNA_ERR_NONFINITE);
    assert_true(distance == -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_distance_is_between_the_mean_levels),
        cmocka_unit_test(bad_input_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
