#include <math.h>
#include <stdlib.h>

#include <vdna/explain.h>
#include <vdna/rank.h>

#include "cmocka_all.h"

/* Binary fractions, so that all sums are exact. */
static const double winner[] = {1, 8, 0, 4}, against[] = {3, 2, 0.5, 8};

static void contributions_are_signed_and_the_greatest_come_first(void **state)
{
    (void)state;
    vdna_reason reasons[3];
    assert_int_equal(vdna_explain_top(winner, against, 4, 3, reasons), VDNA_OK);
    const uint32_t neurons[] = {1, 3, 0};
    const double margins[] = {-1.5, 1, 0.5};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(reasons[i].neuron, neurons[i]);
        assert_int_equal(reasons[i].count, 1);
        assert_true(reasons[i].margin_bins == margins[i]);
        assert_true(reasons[i].winner_bins == winner[neurons[i]] / 4);
        assert_true(reasons[i].against_bins == against[neurons[i]] / 4);
    }
}

static void equal_contributions_keep_the_order_of_the_neurons(void **state)
{
    (void)state;
    const double nothing[] = {0, 0, 0, 0}, same[] = {1, 2, 1, 2};
    vdna_reason reasons[4];
    assert_int_equal(vdna_explain_top(nothing, same, 4, 4, reasons), VDNA_OK);
    const uint32_t expected[] = {1, 3, 0, 2};
    for (int i = 0; i < 4; i++)
        assert_int_equal(reasons[i].neuron, expected[i]);
    assert_int_equal(vdna_explain_top(same, same, 4, 1, reasons), VDNA_OK);
    assert_int_equal(reasons[0].neuron, 0);
}

static void a_sum_is_of_neurons_in_a_row(void **state)
{
    (void)state;
    vdna_reason tap;
    assert_int_equal(vdna_explain_sum(winner, against, 4, 1, 2, &tap), VDNA_OK);
    assert_true(tap.winner_bins == 2 && tap.against_bins == 0.625 && tap.margin_bins == -1.375);
    assert_int_equal(tap.neuron, 1);
    assert_int_equal(tap.count, 2);
}

enum { NEURONS = 97, BINS = 64 };

typedef struct random_dna {
    uint32_t counts[BINS][NEURONS];
    uint32_t mass[NEURONS];
} random_dna;

static vdna_hist_view fill(random_dna *dna, const float *range, uint32_t seed)
{
    srand(seed);
    for (int n = 0; n < NEURONS; n++) {
        dna->mass[n] = 0;
        for (int b = 0; b < BINS; b++)
            dna->mass[n] += dna->counts[b][n] = 1 + (uint32_t)rand() % 5;
    }
    const vdna_hist_view view = {range, dna->counts[0], dna->mass, NEURONS, BINS};
    return view;
}

static void contributions_sum_to_the_distances_and_to_the_margin(void **state)
{
    (void)state;
    static random_dna dna[3];
    static int64_t scratch[2 * NEURONS];
    static double emd[2][NEURONS];
    static vdna_reason reasons[NEURONS];
    float range[NEURONS][2];
    for (int n = 0; n < NEURONS; n++) {
        range[n][0] = 0;
        range[n][1] = 1;
    }
    const vdna_hist_view live = fill(&dna[0], range[0], 1);
    double distance[2];
    for (int i = 0; i < 2; i++) {
        const vdna_hist_view view = fill(&dna[1 + i], range[0], 2 + (uint32_t)i);
        assert_int_equal(vdna_emd(&live, &view, scratch, sizeof scratch, emd[i]), VDNA_OK);
        assert_int_equal(vdna_emd_mean(&live, &view, scratch, sizeof scratch, &distance[i]),
                         VDNA_OK);
    }
    vdna_reason whole, sum = {0, 0, 0, 0, 0};
    assert_int_equal(vdna_explain_sum(emd[0], emd[1], NEURONS, 0, NEURONS, &whole), VDNA_OK);
    assert_int_equal(vdna_explain_top(emd[0], emd[1], NEURONS, NEURONS, reasons), VDNA_OK);
    for (int i = 0; i < NEURONS; i++) {
        sum.winner_bins += reasons[i].winner_bins;
        sum.against_bins += reasons[i].against_bins;
        sum.margin_bins += reasons[i].margin_bins;
        assert_true(i == 0 || fabs(reasons[i].margin_bins) <= fabs(reasons[i - 1].margin_bins));
    }
    assert_true(distance[0] > 0 && distance[1] != distance[0]);
    const vdna_reason *const sums[] = {&whole, &sum};
    for (int i = 0; i < 2; i++) {
        assert_true(fabs(sums[i]->winner_bins - distance[0]) < 1e-9);
        assert_true(fabs(sums[i]->against_bins - distance[1]) < 1e-9);
        assert_true(fabs(sums[i]->margin_bins - (distance[1] - distance[0])) < 1e-9);
    }
}

static void wrong_arguments_are_refused_before_anything_is_written(void **state)
{
    (void)state;
    const double nan_inside[] = {1, NAN, 1, 1}, infinite[] = {1, 1, 1, INFINITY};
    vdna_reason kept = {7, 7, 7, 7, 7};
    assert_int_equal(vdna_explain_sum(NULL, against, 4, 0, 4, &kept), VDNA_ERR_ARG);
    assert_int_equal(vdna_explain_sum(winner, NULL, 4, 0, 4, &kept), VDNA_ERR_ARG);
    assert_int_equal(vdna_explain_sum(winner, against, 4, 0, 0, &kept), VDNA_ERR_ARG);
    assert_int_equal(vdna_explain_sum(winner, against, 4, 0, 5, &kept), VDNA_ERR_ARG);
    assert_int_equal(vdna_explain_sum(winner, against, 4, 1, 4, &kept), VDNA_ERR_ARG);
    assert_int_equal(vdna_explain_sum(winner, against, 4, UINT32_MAX, 1, &kept), VDNA_ERR_ARG);
    assert_int_equal(vdna_explain_sum(winner, against, 4, 0, 4, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_explain_top(NULL, against, 4, 1, &kept), VDNA_ERR_ARG);
    assert_int_equal(vdna_explain_top(winner, NULL, 4, 1, &kept), VDNA_ERR_ARG);
    assert_int_equal(vdna_explain_top(winner, against, 4, 0, &kept), VDNA_ERR_ARG);
    assert_int_equal(vdna_explain_top(winner, against, 4, 5, &kept), VDNA_ERR_ARG);
    assert_int_equal(vdna_explain_top(winner, against, 4, 1, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_explain_top(nan_inside, against, 4, 1, &kept), VDNA_ERR_NONFINITE);
    assert_int_equal(vdna_explain_top(winner, infinite, 4, 1, &kept), VDNA_ERR_NONFINITE);
    assert_true(kept.margin_bins == 7 && kept.neuron == 7);
}

/* Of two neurons; the second has 2, 8, 1, 8, 1, 3 with its scales. */
static const int8_t codes[][2] = {{9, 1}, {9, 4}, {9, 1}, {9, 8}, {9, 1}, {9, 3}};
static const float scale[] = {2, 2, 1, 1, 1, 1};

static void example_frames_have_most_and_least_of_a_neuron(void **state)
{
    (void)state;
    uint32_t most, least;
    assert_int_equal(vdna_explain_frames(codes[0], scale, 6, 2, 1, &most, &least), VDNA_OK);
    assert_int_equal(most, 1);  /* the first of two */
    assert_int_equal(least, 4); /* the farther from it of 2 and 4 */
    assert_int_equal(vdna_explain_frames(codes[2], scale + 2, 2, 2, 1, &most, &least), VDNA_OK);
    assert_int_equal(most, 1);
    assert_int_equal(least, 0);
    /* Of 1 and 3, as far from 2, the first. */
    const int8_t row[] = {2, 1, 4, 1};
    const float ones[] = {1, 1, 1, 1};
    assert_int_equal(vdna_explain_frames(row, ones, 4, 1, 0, &most, &least), VDNA_OK);
    assert_int_equal(most, 2);
    assert_int_equal(least, 1);
}

static void frames_that_all_have_as_much_give_the_first_and_the_last(void **state)
{
    (void)state;
    const int8_t zeros[5] = {0};
    const float none[5] = {0};
    uint32_t most, least;
    assert_int_equal(vdna_explain_frames(zeros, none, 5, 1, 0, &most, &least), VDNA_OK);
    assert_int_equal(most, 0);
    assert_int_equal(least, 4);
    assert_int_equal(vdna_explain_frames(zeros, none, 1, 1, 0, &most, &least), VDNA_OK);
    assert_int_equal(most, 0);
    assert_int_equal(least, 0);
}

static void example_frames_of_nothing_are_refused(void **state)
{
    (void)state;
    uint32_t most = 7, least = 7;
    assert_int_equal(vdna_explain_frames(NULL, scale, 6, 2, 1, &most, &least), VDNA_ERR_ARG);
    assert_int_equal(vdna_explain_frames(codes[0], NULL, 6, 2, 1, &most, &least), VDNA_ERR_ARG);
    assert_int_equal(vdna_explain_frames(codes[0], scale, 0, 2, 1, &most, &least), VDNA_ERR_ARG);
    assert_int_equal(vdna_explain_frames(codes[0], scale, 6, 2, 2, &most, &least), VDNA_ERR_ARG);
    assert_int_equal(vdna_explain_frames(codes[0], scale, 6, 2, 1, NULL, &least), VDNA_ERR_ARG);
    assert_int_equal(vdna_explain_frames(codes[0], scale, 6, 2, 1, &most, NULL), VDNA_ERR_ARG);
    assert_true(most == 7 && least == 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(contributions_are_signed_and_the_greatest_come_first),
        cmocka_unit_test(equal_contributions_keep_the_order_of_the_neurons),
        cmocka_unit_test(a_sum_is_of_neurons_in_a_row),
        cmocka_unit_test(contributions_sum_to_the_distances_and_to_the_margin),
        cmocka_unit_test(wrong_arguments_are_refused_before_anything_is_written),
        cmocka_unit_test(example_frames_have_most_and_least_of_a_neuron),
        cmocka_unit_test(frames_that_all_have_as_much_give_the_first_and_the_last),
        cmocka_unit_test(example_frames_of_nothing_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
