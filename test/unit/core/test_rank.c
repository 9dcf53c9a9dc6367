#include <math.h>

#include <vdna/rank.h>

#include "cmocka_all.h"

static void nearest_comes_first(void **state)
{
    (void)state;
    const double distance[] = {5.5, 1.25, 9, 0.5, 7};
    const uint32_t expected[] = {3, 1, 0, 4, 2};
    vdna_rank_entry ranking[5];
    assert_int_equal(vdna_rank_sort(distance, 5, ranking), VDNA_OK);
    for (int i = 0; i < 5; i++) {
        assert_int_equal(ranking[i].candidate, expected[i]);
        assert_true(ranking[i].distance_bins == distance[expected[i]]);
        assert_int_equal(ranking[i].tied, 0);
    }
}

static void ties_keep_the_order_of_the_map_and_are_marked(void **state)
{
    (void)state;
    const double distance[] = {2, 1, 2, 3, 2};
    const uint32_t expected[] = {1, 0, 2, 4, 3}, tied[] = {0, 1, 1, 1, 0};
    vdna_rank_entry ranking[5];
    assert_int_equal(vdna_rank_sort(distance, 5, ranking), VDNA_OK);
    for (int i = 0; i < 5; i++) {
        assert_int_equal(ranking[i].candidate, expected[i]);
        assert_int_equal(ranking[i].tied, tied[i]);
    }
}

static void any_number_of_candidates_is_sorted(void **state)
{
    (void)state;
    enum { MOST = 200 };
    double distance[MOST];
    vdna_rank_entry ranking[MOST];
    /* 7919 is prime: a permutation of 0..count-1 with every value once, when count is no multiple.
     */
    for (uint32_t count = 1; count <= MOST; count++) {
        for (uint32_t i = 0; i < count; i++)
            distance[i] = (double)((uint64_t)i * 7919 % count);
        assert_int_equal(vdna_rank_sort(distance, count, ranking), VDNA_OK);
        for (uint32_t i = 0; i < count; i++) {
            assert_true(ranking[i].distance_bins == (double)i);
            assert_true(distance[ranking[i].candidate] == (double)i);
        }
    }
}

static void a_distance_that_is_not_finite_is_refused(void **state)
{
    (void)state;
    const double nan_inside[] = {1, NAN}, infinite[] = {INFINITY, 1};
    vdna_rank_entry ranking[2];
    assert_int_equal(vdna_rank_sort(nan_inside, 2, ranking), VDNA_ERR_NONFINITE);
    assert_int_equal(vdna_rank_sort(infinite, 2, ranking), VDNA_ERR_NONFINITE);
    assert_int_equal(vdna_rank_sort(infinite, 0, ranking), VDNA_ERR_ARG);
    assert_int_equal(vdna_rank_sort(NULL, 2, ranking), VDNA_ERR_ARG);
    assert_int_equal(vdna_rank_sort(infinite, 2, NULL), VDNA_ERR_ARG);
}

static void candidates_are_ranked_by_their_distance_to_the_live_histogram(void **state)
{
    (void)state;
    const float range[] = {0, 1};
    const uint32_t live[] = {0, 1, 0, 0}, far[] = {0, 0, 0, 1}, near[] = {1, 0, 0, 0}, mass = 1;
    const vdna_hist_view view = {range, live, &mass, 1, 4};
    const vdna_hist_view candidates[] = {{range, far, &mass, 1, 4}, {range, near, &mass, 1, 4}};
    int64_t scratch[2];
    vdna_rank_entry ranking[2];
    assert_int_equal(vdna_rank(&view, candidates, 2, scratch, sizeof scratch, ranking), VDNA_OK);
    assert_int_equal(ranking[0].candidate, 1);
    assert_true(ranking[0].distance_bins == 1 && ranking[1].distance_bins == 2);
}

static void a_candidate_that_does_not_compare_refuses_the_ranking(void **state)
{
    (void)state;
    const float range[] = {0, 1}, other[] = {0, 2};
    const uint32_t counts[] = {1, 0}, mass = 1;
    const vdna_hist_view live = {range, counts, &mass, 1, 2};
    const vdna_hist_view candidates[] = {live, {other, counts, &mass, 1, 2}};
    int64_t scratch[2];
    vdna_rank_entry ranking[2];
    assert_int_equal(vdna_rank(&live, candidates, 2, scratch, sizeof scratch, ranking),
                     VDNA_ERR_MISMATCH);
    assert_int_equal(vdna_rank(&live, NULL, 2, scratch, sizeof scratch, ranking), VDNA_ERR_ARG);
    assert_int_equal(vdna_rank(&live, candidates, 0, scratch, sizeof scratch, ranking),
                     VDNA_ERR_ARG);
}

/* Two neurons of three bins, in which a bound can be less than the distance: 0.5 and 1 less. */
static void what_is_certainly_farther_keeps_its_bound(void **state)
{
    (void)state;
    const float range[] = {0, 1};
    const uint32_t live[] = {1, 0, 1, 0, 0, 0}, near[] = {0, 1, 1, 0, 0, 0},
                   both_ways[] = {0, 2, 0, 0, 0, 0}, far[] = {0, 0, 0, 0, 2, 0}, mass = 2;
    const vdna_hist_view view = {range, live, &mass, 1, 6};
    const vdna_hist_view candidates[] = {
        {range, far, &mass, 1, 6}, {range, near, &mass, 1, 6}, {range, both_ways, &mass, 1, 6}};
    int64_t scratch[3];
    uint32_t sums[3];
    assert_int_equal(vdna_rank_top_scratch_size(1, 6), 20);
    for (int i = 0; i < 3; i++)
        assert_int_equal(vdna_bounds_sum(&candidates[i], scratch, 16, &sums[i]), VDNA_OK);
    vdna_rank_entry ranking[3];
    uint8_t is_bound[3];
    assert_int_equal(vdna_rank_top(&view, candidates, sums, 3, 1, scratch, 20, ranking, is_bound),
                     VDNA_OK);
    /* The one at distance 1 has the bound 0, so it is looked at first, and does not come first. */
    assert_int_equal(ranking[0].candidate, 1);
    assert_true(ranking[0].distance_bins == 0.5);
    assert_int_equal(ranking[1].candidate, 2);
    assert_true(ranking[1].distance_bins == 1);
    assert_int_equal(ranking[2].candidate, 0);
    assert_true(ranking[2].distance_bins == 3);
    assert_int_equal(is_bound[0], 1);
    assert_int_equal(is_bound[1] + is_bound[2], 0);
}

static void bad_arguments_of_a_top_are_refused(void **state)
{
    (void)state;
    const float range[] = {0, 1}, other[] = {0, 2};
    const uint32_t counts[] = {1, 0}, mass = 1, none = 0, much = UINT32_MAX;
    const vdna_hist_view good = {range, counts, &mass, 1, 2};
    const vdna_hist_view bad = {other, counts, &mass, 1, 2}, empty = {range, counts, &none, 1, 2};
    const uint32_t most[] = {UINT32_MAX, 0}, fewer[] = {UINT32_MAX - 1, 0}, less = UINT32_MAX - 1;
    const vdna_hist_view p = {range, most, &much, 1, 2}, q = {range, fewer, &less, 1, 2};
    const uint32_t sums[] = {1};
    int64_t scratch[3];
    vdna_rank_entry out[1];
    uint8_t is[1];
    assert_int_equal(vdna_rank_top_scratch_size(0, 2), 0);
    assert_int_equal(vdna_rank_top(NULL, &good, sums, 1, 1, scratch, 20, out, is), VDNA_ERR_ARG);
    assert_int_equal(vdna_rank_top(&good, NULL, sums, 1, 1, scratch, 20, out, is), VDNA_ERR_ARG);
    assert_int_equal(vdna_rank_top(&good, &good, NULL, 1, 1, scratch, 20, out, is), VDNA_ERR_ARG);
    assert_int_equal(vdna_rank_top(&good, &good, sums, 0, 1, scratch, 20, out, is), VDNA_ERR_ARG);
    assert_int_equal(vdna_rank_top(&good, &good, sums, 1, 0, scratch, 20, out, is), VDNA_ERR_ARG);
    assert_int_equal(vdna_rank_top(&good, &good, sums, 1, 1, NULL, 20, out, is), VDNA_ERR_ARG);
    assert_int_equal(vdna_rank_top(&good, &good, sums, 1, 1, scratch, 20, NULL, is), VDNA_ERR_ARG);
    assert_int_equal(vdna_rank_top(&good, &good, sums, 1, 1, scratch, 20, out, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_rank_top(&good, &good, sums, 1, 1, scratch, 19, out, is), VDNA_ERR_NOMEM);
    assert_int_equal(vdna_rank_top(&empty, &good, sums, 1, 1, scratch, 20, out, is),
                     VDNA_ERR_EMPTY);
    assert_int_equal(vdna_rank_top(&good, &bad, sums, 1, 1, scratch, 20, out, is),
                     VDNA_ERR_MISMATCH);
    assert_int_equal(vdna_rank_top(&p, &q, sums, 1, 1, scratch, 20, out, is), VDNA_ERR_OVERFLOW);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nearest_comes_first),
        cmocka_unit_test(ties_keep_the_order_of_the_map_and_are_marked),
        cmocka_unit_test(any_number_of_candidates_is_sorted),
        cmocka_unit_test(a_distance_that_is_not_finite_is_refused),
        cmocka_unit_test(candidates_are_ranked_by_their_distance_to_the_live_histogram),
        cmocka_unit_test(a_candidate_that_does_not_compare_refuses_the_ranking),
        cmocka_unit_test(what_is_certainly_farther_keeps_its_bound),
        cmocka_unit_test(bad_arguments_of_a_top_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
