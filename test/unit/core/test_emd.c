#include <string.h>

#include <vdna/emd.h>

#include "cmocka_all.h"

#define BINS 5

static const float range[] = {0, 1, 0, 1};

/* A view of one neuron whose counts the test writes out. */
static vdna_hist_view one_neuron(const uint32_t counts[BINS], const uint32_t *mass)
{
    const vdna_hist_view view = {range, counts, mass, 1, BINS};
    return view;
}

static double distance(const uint32_t p[BINS], uint32_t mass_p, const uint32_t q[BINS],
                       uint32_t mass_q)
{
    const vdna_hist_view view_p = one_neuron(p, &mass_p), view_q = one_neuron(q, &mass_q);
    int64_t scratch[2];
    double emd = -1;
    assert_int_equal(vdna_emd(&view_p, &view_q, scratch, sizeof scratch, &emd), VDNA_OK);
    return emd;
}

static void moving_everything_by_k_bins_costs_k(void **state)
{
    (void)state;
    const uint32_t p[BINS] = {3, 1, 0, 0, 0}, by_one[BINS] = {0, 3, 1, 0, 0};
    const uint32_t by_three[BINS] = {0, 0, 0, 3, 1};
    assert_true(distance(p, 4, p, 4) == 0);
    assert_true(distance(p, 4, by_one, 4) == 1);
    assert_true(distance(p, 4, by_three, 4) == 3);
    assert_true(distance(by_three, 4, p, 4) == 3);
}

static void the_largest_distance_is_from_the_first_bin_to_the_last(void **state)
{
    (void)state;
    const uint32_t first[BINS] = {7, 0, 0, 0, 0}, last[BINS] = {0, 0, 0, 0, 2};
    assert_true(distance(first, 7, last, 2) == BINS - 1);
}

static void masses_need_not_be_equal(void **state)
{
    (void)state;
    /* Cumulative: 1/2 1 1 1 1 against 1/4 2/4 3/4 1 1: |1/4| + |1/2| + |1/4| = 1. */
    const uint32_t p[BINS] = {1, 1, 0, 0, 0}, q[BINS] = {1, 1, 1, 1, 0};
    assert_true(distance(p, 2, q, 4) == 1);
}

static void the_same_shape_with_twice_the_mass_is_at_distance_zero(void **state)
{
    (void)state;
    const uint32_t p[BINS] = {1, 0, 2, 0, 0}, doubled[BINS] = {2, 0, 4, 0, 0};
    assert_true(distance(p, 3, doubled, 6) == 0);
}

static void sums_are_exact_on_both_sides_of_32_bits(void **state)
{
    (void)state;
    const uint32_t one[BINS] = {1, 0, 0, 0, 0};
    for (uint32_t mass = INT32_MAX / (BINS - 1) - 1; mass <= INT32_MAX / (BINS - 1) + 2; mass++) {
        const uint32_t far[BINS] = {0, 0, 0, 0, mass}, near[BINS] = {mass - 1, 1, 0, 0, 0};
        assert_true(distance(one, 1, far, mass) == BINS - 1);
        assert_true(distance(far, mass, one, 1) == BINS - 1);
        assert_true(distance(one, 1, near, mass) == 1.0 / mass);
    }
}

static void one_neuron_of_large_mass_spoils_no_other(void **state)
{
    (void)state;
    const uint32_t large = 3000000000u, counts_p[] = {large, 1, 0, 0},
                   counts_q[] = {0, 0, large, 1};
    const uint32_t mass[] = {large, 1};
    const vdna_hist_view p = {range, counts_p, mass, 2, 2}, q = {range, counts_q, mass, 2, 2};
    int64_t scratch[4];
    double emd[2];
    assert_int_equal(vdna_emd(&p, &q, scratch, sizeof scratch, emd), VDNA_OK);
    assert_true(emd[0] == 1 && emd[1] == 1);
}

static void neurons_of_different_masses_are_each_compared_by_their_own(void **state)
{
    (void)state;
    enum { NEURONS = 6 };
    const float six[2 * NEURONS] = {0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1};
    const uint32_t p[BINS][NEURONS] = {{1, 4, 0, 6, 1, 0}, {3, 0, 6, 0, 3, 1}};
    const uint32_t q[BINS][NEURONS] = {{0, 3, 1}, {0}, {3, 0, 2, 2, 9, 0}, {0}, {0, 0, 0, 1, 0, 5}};
    const uint32_t mass_p[] = {4, 4, 6, 6, 4, 1}, mass_q[] = {3, 3, 3, 3, 9, 5};
    const vdna_hist_view view_p = {six, p[0], mass_p, NEURONS, BINS};
    const vdna_hist_view view_q = {six, q[0], mass_q, NEURONS, BINS};
    int64_t scratch[2 * NEURONS];
    double emd[NEURONS];
    assert_int_equal(vdna_emd(&view_p, &view_q, scratch, sizeof scratch, emd), VDNA_OK);
    for (size_t n = 0; n < NEURONS; n++) {
        uint32_t one_p[BINS], one_q[BINS];
        for (size_t b = 0; b < BINS; b++) {
            one_p[b] = p[b][n];
            one_q[b] = q[b][n];
        }
        assert_true(emd[n] == distance(one_p, mass_p[n], one_q, mass_q[n]));
    }
    assert_true(emd[3] == 8.0 / 3 && emd[5] == 3);
}

static void the_mean_is_over_neurons_and_bins_are_rows(void **state)
{
    (void)state;
    /* Neuron 0 does not move, neuron 1 moves by two bins. */
    const uint32_t p[] = {1, 1, 0, 0, 0, 0, 0, 0, 0, 0}, q[] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0};
    const uint32_t mass[] = {1, 1};
    const vdna_hist_view view_p = {range, p, mass, 2, BINS}, view_q = {range, q, mass, 2, BINS};
    int64_t scratch[4];
    double emd[2], mean;
    assert_int_equal(vdna_emd_scratch_size(2), sizeof scratch);
    assert_int_equal(vdna_emd(&view_p, &view_q, scratch, sizeof scratch, emd), VDNA_OK);
    assert_true(emd[0] == 0 && emd[1] == 2);
    assert_int_equal(vdna_emd_mean(&view_p, &view_q, scratch, sizeof scratch, &mean), VDNA_OK);
    assert_true(mean == 1);
}

/* Status of comparing two views, checking that a refusal leaves the output alone. */
static vdna_status status_of(const vdna_hist_view *p, const vdna_hist_view *q)
{
    int64_t scratch[4];
    double emd[2] = {-1, -1}, mean = -1;
    const vdna_status status = vdna_emd(p, q, scratch, sizeof scratch, emd);
    assert_int_equal(vdna_emd_mean(p, q, scratch, sizeof scratch, &mean), status);
    if (status != VDNA_OK)
        assert_true(emd[0] == -1 && mean == -1);
    return status;
}

static void an_empty_histogram_has_no_distance(void **state)
{
    (void)state;
    const uint32_t counts[BINS] = {1}, zeros[BINS] = {0}, one = 1, none = 0;
    const vdna_hist_view full = one_neuron(counts, &one), empty = one_neuron(zeros, &none);
    assert_int_equal(status_of(&full, &empty), VDNA_ERR_EMPTY);
    assert_int_equal(status_of(&empty, &full), VDNA_ERR_EMPTY);
    assert_int_equal(status_of(&empty, &empty), VDNA_ERR_EMPTY);
}

static void histograms_of_other_ranges_or_shapes_do_not_compare(void **state)
{
    (void)state;
    const float same[] = {0, 1}, other[] = {0, 2};
    const uint32_t counts[2 * BINS] = {1, 1}, mass[] = {1, 1};
    const vdna_hist_view p = {range, counts, mass, 1, BINS};
    vdna_hist_view q = p;
    q.range = same;
    assert_int_equal(status_of(&p, &q), VDNA_OK);
    q.range = other;
    assert_int_equal(status_of(&p, &q), VDNA_ERR_MISMATCH);
    q = p;
    q.bins = BINS - 1;
    assert_int_equal(status_of(&p, &q), VDNA_ERR_MISMATCH);
    q = p;
    q.neurons = 2;
    assert_int_equal(status_of(&p, &q), VDNA_ERR_MISMATCH);
}

static void masses_beyond_the_exact_bound_are_refused(void **state)
{
    (void)state;
    /* The bound for 5 bins: the least common multiple <= INT64_MAX / 4 = 2^61 - 1. */
    const uint32_t p[BINS] = {1u << 31}, q[BINS] = {0, 0, 0, 0, (1u << 30) + 1};
    const uint32_t mass_p = 1u << 31, mass_q = (1u << 30) + 1;
    const vdna_hist_view view_p = one_neuron(p, &mass_p), view_q = one_neuron(q, &mass_q);
    assert_int_equal(status_of(&view_p, &view_q), VDNA_ERR_OVERFLOW);

    const uint32_t less_q[BINS] = {0, 0, 0, 0, (1u << 30) - 1};
    assert_true(distance(p, mass_p, less_q, (1u << 30) - 1) == BINS - 1);

    /* Equal masses are their own multiple. */
    const uint32_t most = UINT32_MAX, far_p[BINS] = {UINT32_MAX}, far_q[BINS] = {0, 0, UINT32_MAX};
    assert_true(distance(far_p, most, far_q, most) == 2);
}

static void bad_arguments_are_refused(void **state)
{
    (void)state;
    const uint32_t counts[BINS] = {1}, mass = 1;
    const vdna_hist_view good = one_neuron(counts, &mass);
    int64_t scratch[3];
    double emd;
    assert_int_equal(vdna_emd(NULL, &good, scratch, 16, &emd), VDNA_ERR_ARG);
    assert_int_equal(vdna_emd(&good, NULL, scratch, 16, &emd), VDNA_ERR_ARG);
    assert_int_equal(vdna_emd(&good, &good, NULL, 16, &emd), VDNA_ERR_ARG);
    assert_int_equal(vdna_emd(&good, &good, (char *)scratch + 4, 16, &emd), VDNA_ERR_ARG);
    assert_int_equal(vdna_emd(&good, &good, scratch, 15, &emd), VDNA_ERR_NOMEM);
    assert_int_equal(vdna_emd(&good, &good, scratch, 16, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_emd_mean(&good, &good, scratch, 16, NULL), VDNA_ERR_ARG);
    vdna_hist_view bad = good;
    bad.bins = 1;
    assert_int_equal(status_of(&bad, &bad), VDNA_ERR_ARG);
    bad = good;
    bad.counts = NULL;
    assert_int_equal(status_of(&good, &bad), VDNA_ERR_ARG);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(moving_everything_by_k_bins_costs_k),
        cmocka_unit_test(the_largest_distance_is_from_the_first_bin_to_the_last),
        cmocka_unit_test(masses_need_not_be_equal),
        cmocka_unit_test(the_same_shape_with_twice_the_mass_is_at_distance_zero),
        cmocka_unit_test(sums_are_exact_on_both_sides_of_32_bits),
        cmocka_unit_test(one_neuron_of_large_mass_spoils_no_other),
        cmocka_unit_test(neurons_of_different_masses_are_each_compared_by_their_own),
        cmocka_unit_test(the_mean_is_over_neurons_and_bins_are_rows),
        cmocka_unit_test(an_empty_histogram_has_no_distance),
        cmocka_unit_test(histograms_of_other_ranges_or_shapes_do_not_compare),
        cmocka_unit_test(masses_beyond_the_exact_bound_are_refused),
        cmocka_unit_test(bad_arguments_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
