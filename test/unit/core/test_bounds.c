#include <string.h>

#include <vdna/bounds.h>

#include "cmocka_all.h"

enum { BINS = 60, BLOCKS = 3 }; /* of 25, 25 and 9 bins, the last bin left out */

static const float range[] = {0, 1, 0, 1};

/* One neuron with `mass` samples in each of two bins. */
typedef struct two_heaps {
    uint32_t counts[BINS], mass, sums[BLOCKS];
    vdna_hist_view view;
} two_heaps;

static void fill(two_heaps *h, uint32_t bin, uint32_t other, uint32_t each)
{
    memset(h, 0, sizeof *h);
    h->counts[bin] += each;
    h->counts[other] += each;
    h->mass = 2 * each;
    const vdna_hist_view view = {range, h->counts, &h->mass, 1, BINS};
    h->view = view;
    int64_t scratch[2];
    assert_int_equal(vdna_bounds_sum(&h->view, scratch, sizeof scratch, h->sums), VDNA_OK);
}

static double bound(const two_heaps *p, const two_heaps *q)
{
    int64_t scratch[2];
    double bins = -1;
    assert_int_equal(
        vdna_bounds_mean(&p->view, p->sums, &q->view, q->sums, scratch, sizeof scratch, &bins),
        VDNA_OK);
    return bins;
}

static void a_block_has_the_sum_of_its_cumulative_counts(void **state)
{
    (void)state;
    two_heaps h;
    fill(&h, 20, 26, 3);
    assert_int_equal(vdna_bounds_size(1, BINS), sizeof h.sums);
    assert_int_equal(h.sums[0], 5 * 3);          /* bins 20 to 24 */
    assert_int_equal(h.sums[1], 3 + 24 * 2 * 3); /* bin 25, then 26 to 49 */
    assert_int_equal(h.sums[2], 9 * 2 * 3);      /* bins 50 to 58 */
}

static void the_bound_is_the_distance_if_all_samples_move_the_same_way(void **state)
{
    (void)state;
    two_heaps p, q;
    fill(&p, 3, 20, 1);
    fill(&q, 30, 59, 7);
    assert_true(bound(&p, &q) == (27 + 39) / 2.0);
    assert_true(bound(&q, &p) == (27 + 39) / 2.0);
    assert_true(bound(&p, &p) == 0);
}

static void what_moves_both_ways_within_a_block_cancels(void **state)
{
    (void)state;
    two_heaps p, q, far;
    fill(&p, 4, 10, 1);
    fill(&q, 2, 12, 2);
    fill(&far, 2, 42, 2);
    assert_true(bound(&p, &q) == 0);
    /* Bins 2 and 3 against 10 to 24, in halves, and then 25 to 41. */
    assert_true(bound(&p, &far) == ((25 - 10) - 2 + (42 - 25)) / 2.0);
}

static void sizes_are_those_of_the_blocks(void **state)
{
    (void)state;
    assert_int_equal(vdna_bounds_size(7, 2), 7 * 4);
    assert_int_equal(vdna_bounds_size(7, 26), 7 * 4);
    assert_int_equal(vdna_bounds_size(7, 27), 7 * 2 * 4);
    assert_int_equal(vdna_bounds_size(768, 1000), 768 * 40 * 4);
    assert_int_equal(vdna_bounds_size(0, 1000), 0);
    assert_int_equal(vdna_bounds_size(7, 1), 0);
    assert_int_equal(vdna_bounds_size(7, 65537), 0);
}

static void neurons_of_different_masses_are_each_bounded_by_their_own(void **state)
{
    (void)state;
    /* Neuron 0 moves by one bin, neuron 1 by half of its samples by 2. */
    const uint32_t p[] = {3, 2, 0, 0, 0, 0}, q[] = {0, 2, 1, 0, 0, 2}, mass_p[] = {3, 2},
                   mass_q[] = {1, 4};
    const vdna_hist_view view_p = {range, p, mass_p, 2, 3}, view_q = {range, q, mass_q, 2, 3};
    uint32_t sums_p[2], sums_q[2];
    int64_t scratch[4];
    double bins = -1;
    assert_int_equal(vdna_bounds_sum(&view_p, scratch, sizeof scratch, sums_p), VDNA_OK);
    assert_int_equal(vdna_bounds_sum(&view_q, scratch, sizeof scratch, sums_q), VDNA_OK);
    assert_int_equal(
        vdna_bounds_mean(&view_p, sums_p, &view_q, sums_q, scratch, sizeof scratch, &bins),
        VDNA_OK);
    assert_true(bins == 1);
}

static void sums_are_enough_for_the_bound(void **state)
{
    (void)state;
    /* Neuron 0 has 24 and 5 of 4 samples, neuron 1 has 3 of 1 sample and 21 of 2. */
    const uint32_t p[] = {24, 3}, mass_p[] = {4, 1}, q[] = {5, 21}, mass_q[] = {4, 2};
    int64_t scratch[4];
    double bins = -1;
    assert_int_equal(
        vdna_bounds_from_sums(p, mass_p, q, mass_q, 2, 26, scratch, sizeof scratch, &bins),
        VDNA_OK);
    assert_true(bins == ((24 - 5) / 4.0 + (21 - 2 * 3) / 2.0) / 2);
}

static void bad_arguments_for_rows_of_sums_are_refused(void **state)
{
    (void)state;
    const uint32_t sums[] = {1, 2}, mass[] = {3, 1}, empty[] = {3, 0};
    int64_t scratch[4];
    const size_t size = sizeof scratch;
    double bins = -1;
    vdna_status (*const f)(const uint32_t *, const uint32_t *, const uint32_t *, const uint32_t *,
                           uint32_t, uint32_t, void *, size_t, double *) = vdna_bounds_from_sums;
    assert_int_equal(f(NULL, mass, sums, mass, 2, 9, scratch, size, &bins), VDNA_ERR_ARG);
    assert_int_equal(f(sums, NULL, sums, mass, 2, 9, scratch, size, &bins), VDNA_ERR_ARG);
    assert_int_equal(f(sums, mass, NULL, mass, 2, 9, scratch, size, &bins), VDNA_ERR_ARG);
    assert_int_equal(f(sums, mass, sums, NULL, 2, 9, scratch, size, &bins), VDNA_ERR_ARG);
    assert_int_equal(f(sums, mass, sums, mass, 0, 9, scratch, size, &bins), VDNA_ERR_ARG);
    assert_int_equal(f(sums, mass, sums, mass, 2, 1, scratch, size, &bins), VDNA_ERR_ARG);
    assert_int_equal(f(sums, mass, sums, mass, 2, 65537, scratch, size, &bins), VDNA_ERR_ARG);
    assert_int_equal(f(sums, mass, sums, mass, 2, 9, scratch, size, NULL), VDNA_ERR_ARG);
    assert_int_equal(f(sums, mass, sums, mass, 2, 9, NULL, size, &bins), VDNA_ERR_ARG);
    assert_int_equal(f(sums, mass, sums, mass, 2, 9, (char *)scratch + 4, size, &bins),
                     VDNA_ERR_ARG);
    assert_int_equal(f(sums, mass, sums, mass, 2, 9, scratch, size - 1, &bins), VDNA_ERR_NOMEM);
    assert_int_equal(f(sums, empty, sums, mass, 2, 9, scratch, size, &bins), VDNA_ERR_EMPTY);
    assert_int_equal(f(sums, mass, sums, empty, 2, 9, scratch, size, &bins), VDNA_ERR_EMPTY);
    assert_true(bins == -1);
}

static void sums_that_pass_32_bits_are_refused(void **state)
{
    (void)state;
    uint32_t counts[BINS] = {UINT32_MAX / 25}, sums[BLOCKS];
    uint32_t mass = counts[0];
    const vdna_hist_view view = {range, counts, &mass, 1, BINS},
                         short_view = {range, counts, &mass, 1, 5};
    int64_t scratch[2];
    assert_int_equal(vdna_bounds_sum(&view, scratch, sizeof scratch, sums), VDNA_OK);
    assert_int_equal(sums[0], UINT32_MAX / 25 * 25);
    mass = counts[0] += 1;
    assert_int_equal(vdna_bounds_sum(&view, scratch, sizeof scratch, sums), VDNA_ERR_OVERFLOW);
    /* Of 5 bins, 4 are summed. */
    mass = counts[0] = UINT32_MAX / 4;
    assert_int_equal(vdna_bounds_sum(&short_view, scratch, sizeof scratch, sums), VDNA_OK);
    mass = counts[0] += 1;
    assert_int_equal(vdna_bounds_sum(&short_view, scratch, sizeof scratch, sums),
                     VDNA_ERR_OVERFLOW);
}

static void masses_beyond_the_exact_bound_are_refused(void **state)
{
    (void)state;
    const uint32_t counts[] = {1, 0, 0, 0, 0}, sums[] = {4};
    const uint32_t mass_p = 1u << 31, mass_q = (1u << 30) + 1;
    const vdna_hist_view p = {range, counts, &mass_p, 1, 5}, q = {range, counts, &mass_q, 1, 5};
    int64_t scratch[2];
    double bins = -1;
    assert_int_equal(vdna_bounds_mean(&p, sums, &q, sums, scratch, sizeof scratch, &bins),
                     VDNA_ERR_OVERFLOW);
    assert_true(bins == -1);
}

static void bad_arguments_are_refused(void **state)
{
    (void)state;
    two_heaps h;
    fill(&h, 1, 2, 1);
    int64_t scratch[2];
    double bins = -1;
    const vdna_hist_view *const view = &h.view;
    assert_int_equal(vdna_bounds_sum(NULL, scratch, 16, h.sums), VDNA_ERR_ARG);
    assert_int_equal(vdna_bounds_sum(view, NULL, 16, h.sums), VDNA_ERR_ARG);
    assert_int_equal(vdna_bounds_sum(view, scratch, 15, h.sums), VDNA_ERR_NOMEM);
    assert_int_equal(vdna_bounds_sum(view, scratch, 16, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_bounds_mean(view, NULL, view, h.sums, scratch, 16, &bins), VDNA_ERR_ARG);
    assert_int_equal(vdna_bounds_mean(view, h.sums, view, NULL, scratch, 16, &bins), VDNA_ERR_ARG);
    assert_int_equal(vdna_bounds_mean(view, h.sums, NULL, h.sums, scratch, 16, &bins),
                     VDNA_ERR_ARG);
    assert_int_equal(vdna_bounds_mean(view, h.sums, view, h.sums, scratch, 15, &bins),
                     VDNA_ERR_NOMEM);
    assert_int_equal(vdna_bounds_mean(view, h.sums, view, h.sums, scratch, 16, NULL), VDNA_ERR_ARG);
    h.mass = 0;
    assert_int_equal(vdna_bounds_sum(view, scratch, 16, h.sums), VDNA_ERR_EMPTY);
    assert_int_equal(vdna_bounds_mean(view, h.sums, view, h.sums, scratch, 16, &bins),
                     VDNA_ERR_EMPTY);
    assert_true(bins == -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_block_has_the_sum_of_its_cumulative_counts),
        cmocka_unit_test(the_bound_is_the_distance_if_all_samples_move_the_same_way),
        cmocka_unit_test(what_moves_both_ways_within_a_block_cancels),
        cmocka_unit_test(sizes_are_those_of_the_blocks),
        cmocka_unit_test(neurons_of_different_masses_are_each_bounded_by_their_own),
        cmocka_unit_test(sums_are_enough_for_the_bound),
        cmocka_unit_test(bad_arguments_for_rows_of_sums_are_refused),
        cmocka_unit_test(sums_that_pass_32_bits_are_refused),
        cmocka_unit_test(masses_beyond_the_exact_bound_are_refused),
        cmocka_unit_test(bad_arguments_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
