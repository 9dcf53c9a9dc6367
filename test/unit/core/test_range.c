#include <math.h>
#include <string.h>

#include <vdna/range.h>

#include "cmocka_all.h"

#define NEURONS 2

static vdna_activations descriptor(const float *values)
{
    const vdna_activations tap = {values, NEURONS, 1, VDNA_LAYOUT_SAMPLES_NEURONS};
    return tap;
}

static void observing_keeps_the_smallest_and_largest_of_each_neuron(void **state)
{
    (void)state;
    const float first[NEURONS] = {1, -1}, second[NEURONS] = {3, -5};
    const float expected[] = {1, 3, -5, -1};
    float range[2 * NEURONS];
    const vdna_activations a = descriptor(first), b = descriptor(second);
    assert_int_equal(vdna_range_clear(range, NEURONS), VDNA_OK);
    assert_int_equal(vdna_range_observe(range, NEURONS, &a, 1), VDNA_OK);
    assert_int_equal(vdna_range_observe(range, NEURONS, &b, 1), VDNA_OK);
    assert_memory_equal(range, expected, sizeof expected);
}

static void both_layouts_observe_the_same(void **state)
{
    (void)state;
    /* Neuron 0 gives 1 2 3, neuron 1 gives 10 20 30. */
    const float tokens[] = {1, 10, 2, 20, 3, 30}, channels[] = {1, 2, 3, 10, 20, 30};
    const vdna_activations by_token = {tokens, 2, 3, VDNA_LAYOUT_SAMPLES_NEURONS};
    const vdna_activations by_channel = {channels, 2, 3, VDNA_LAYOUT_NEURONS_SAMPLES};
    const float expected[] = {1, 3, 10, 30};
    float range[4];
    vdna_range_clear(range, 2);
    assert_int_equal(vdna_range_observe(range, 2, &by_token, 1), VDNA_OK);
    assert_memory_equal(range, expected, sizeof expected);
    vdna_range_clear(range, 2);
    assert_int_equal(vdna_range_observe(range, 2, &by_channel, 1), VDNA_OK);
    assert_memory_equal(range, expected, sizeof expected);
}

static void taps_follow_one_another(void **state)
{
    (void)state;
    const float first = 1, second = 2;
    const vdna_activations taps[] = {{&first, 1, 1, 0}, {&second, 1, 1, 0}};
    const float expected[] = {1, 1, 2, 2};
    float range[4];
    vdna_range_clear(range, 2);
    assert_int_equal(vdna_range_observe(range, 2, taps, 2), VDNA_OK);
    assert_memory_equal(range, expected, sizeof expected);
}

static void a_nan_leaves_the_table_as_it_was(void **state)
{
    (void)state;
    const float good[NEURONS] = {1, 2}, bad[NEURONS] = {-9, NAN};
    const vdna_activations a = descriptor(good), b = descriptor(bad);
    float range[2 * NEURONS], before[2 * NEURONS];
    vdna_range_clear(range, NEURONS);
    vdna_range_observe(range, NEURONS, &a, 1);
    memcpy(before, range, sizeof before);
    assert_int_equal(vdna_range_observe(range, NEURONS, &b, 1), VDNA_ERR_NONFINITE);
    assert_memory_equal(range, before, sizeof before);
}

static void expanding_about_the_midpoint_widens_both_sides_alike(void **state)
{
    (void)state;
    float range[] = {10, 20};
    assert_int_equal(vdna_range_expand(range, 1, 2, VDNA_RANGE_ABOUT_MIDPOINT), VDNA_OK);
    assert_true(range[0] == 5 && range[1] == 25);
}

static void expanding_about_zero_is_the_reference_rule(void **state)
{
    (void)state;
    float range[] = {10, 20};
    assert_int_equal(vdna_range_expand(range, 1, 2, VDNA_RANGE_ABOUT_ZERO), VDNA_OK);
    assert_true(range[0] == 20 && range[1] == 40);
}

static void a_constant_neuron_gets_half_width_one(void **state)
{
    (void)state;
    float range[] = {3, 3};
    assert_int_equal(vdna_range_expand(range, 1, VDNA_RANGE_FACTOR, 0), VDNA_OK);
    assert_true(range[0] == 2 && range[1] == 4);
}

static void expanding_a_table_that_saw_nothing_is_refused(void **state)
{
    (void)state;
    float range[4] = {1, 2, 0, 0};
    vdna_range_clear(range + 2, 1);
    assert_int_equal(vdna_range_expand(range, 2, 2, 0), VDNA_ERR_EMPTY);
    assert_true(range[0] == 1 && range[1] == 2);
}

static void an_edge_that_leaves_the_floats_is_refused(void **state)
{
    (void)state;
    float wide[] = {-3e38f, 3e38f};
    assert_int_equal(vdna_range_expand(wide, 1, 2, 0), VDNA_ERR_NONFINITE);
    /* 1e30 - 1 is 1e30 as a float. */
    float swallowed[] = {1e30f, 1e30f};
    assert_int_equal(vdna_range_expand(swallowed, 1, 2, 0), VDNA_ERR_NONFINITE);
}

static void bad_factors_and_rules_are_refused(void **state)
{
    (void)state;
    float range[] = {0, 1};
    assert_int_equal(vdna_range_expand(range, 1, 0.5f, 0), VDNA_ERR_ARG);
    assert_int_equal(vdna_range_expand(range, 1, NAN, 0), VDNA_ERR_ARG);
    assert_int_equal(vdna_range_expand(range, 1, 2, 2), VDNA_ERR_ARG);
    assert_int_equal(vdna_range_expand(NULL, 1, 2, 0), VDNA_ERR_ARG);
    assert_true(range[0] == 0 && range[1] == 1);
}

static void checking_refuses_empty_reversed_and_infinite_ranges(void **state)
{
    (void)state;
    const float good[] = {0, 1}, empty[] = {1, 1}, reversed[] = {2, 1}, infinite[] = {0, INFINITY};
    assert_int_equal(vdna_range_check(good, 1), VDNA_OK);
    assert_int_equal(vdna_range_check(empty, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_range_check(reversed, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_range_check(infinite, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_range_check(good, 0), VDNA_ERR_ARG);
    assert_int_equal(vdna_range_check(NULL, 1), VDNA_ERR_ARG);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(observing_keeps_the_smallest_and_largest_of_each_neuron),
        cmocka_unit_test(both_layouts_observe_the_same),
        cmocka_unit_test(taps_follow_one_another),
        cmocka_unit_test(a_nan_leaves_the_table_as_it_was),
        cmocka_unit_test(expanding_about_the_midpoint_widens_both_sides_alike),
        cmocka_unit_test(expanding_about_zero_is_the_reference_rule),
        cmocka_unit_test(a_constant_neuron_gets_half_width_one),
        cmocka_unit_test(expanding_a_table_that_saw_nothing_is_refused),
        cmocka_unit_test(an_edge_that_leaves_the_floats_is_refused),
        cmocka_unit_test(bad_factors_and_rules_are_refused),
        cmocka_unit_test(checking_refuses_empty_reversed_and_infinite_ranges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
