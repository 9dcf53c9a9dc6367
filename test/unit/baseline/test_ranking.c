#include <math.h>

#include <vdna/baseline.h>

#include "cmocka_all.h"

#define NONE NAN

/* The paper's tables for Nordland test:2 with CosPlace. Queries and references in the order Fall,
 * Winter, Summer, Spring; recalls are counts of 196 frames. */
#define PERCENT(count) ((count) * 100.0 / 196)
static const double paper_recall[] = {
    NONE,         PERCENT(82),  PERCENT(194), PERCENT(166), /* Fall */
    PERCENT(79),  NONE,         PERCENT(95),  PERCENT(120), /* Winter */
    PERCENT(195), PERCENT(90),  NONE,         PERCENT(166), /* Summer */
    PERCENT(167), PERCENT(106), PERCENT(163), NONE,         /* Spring */
};
static const double paper_dna[] = {
    NONE, 11.53, 5.68, 6.71, 11.27, NONE, 11.22, 9.11,
    5.41, 10.94, NONE, 6.67, 8.05,  9.63, 8.23,  NONE,
};
static const double paper_frechet[] = {
    NONE, .615, .264, .308, .566, NONE, .568, .435, .252, .583, NONE, .306, .371, .476, .384, NONE,
};
static const double paper_pixel[] = {
    NONE, 20.97, 9.35, 15.45, 27.50, NONE, 30.19, 5.38,
    7.91, 19.73, NONE, 14.21, 26.48, 1.15, 29.17, NONE,
};

static vdna_ranking_metrics judge(const double *recall, const double *distance, uint32_t queries,
                                  uint32_t references)
{
    const vdna_ranking_table table = {recall, distance, queries, references};
    vdna_ranking_metrics metrics;
    assert_int_equal(vdna_judge_ranking(&table, &metrics), VDNA_OK);
    return metrics;
}

static double paper_error(const double *distance)
{
    return judge(paper_recall, distance, 4, 4).ranking_error_swap_once;
}

static void the_ranking_errors_of_the_paper_are_reproduced(void **state)
{
    (void)state;
    assert_true(paper_error(paper_dna) == 0);
    assert_true(fabs(paper_error(paper_frechet) - 0.680) < 5e-4);
    assert_true(fabs(paper_error(paper_pixel) - 5.867) < 5e-4);
    assert_true(fabs(paper_error(NULL) - 13.562) < 1e-3);
}

static void a_swapped_pair_counts_once_and_half_of_each_rank(void **state)
{
    (void)state;
    const double recall[] = {90, 60, 30}, distance[] = {2, 1, 3};
    const vdna_ranking_metrics m = judge(recall, distance, 1, 3);
    assert_true(m.ranking_error_swap_once == 10);
    assert_true(m.ranking_error_half_l1 == 10);
    assert_true(m.regret == 30);
}

static void a_rotation_counts_each_of_its_three_pairs(void **state)
{
    (void)state;
    /* Truth 0 1 2, prediction 1 2 0: pairs {0,1} 30, {1,2} 30, {0,2} 60. */
    const double recall[] = {90, 60, 30}, distance[] = {3, 1, 2};
    const vdna_ranking_metrics m = judge(recall, distance, 1, 3);
    assert_true(m.ranking_error_swap_once == 40);
    assert_true(m.ranking_error_half_l1 == 20);
    assert_true(m.regret == 30);
}

static void the_random_errors_are_the_means_over_all_permutations(void **state)
{
    (void)state;
    const double recall[] = {90, 60, 20};
    const double orders[6][3] = {{1, 2, 3}, {1, 3, 2}, {2, 1, 3}, {2, 3, 1}, {3, 1, 2}, {3, 2, 1}};
    double swap_once = 0, half_l1 = 0, regret = 0;
    for (int i = 0; i < 6; i++) {
        const vdna_ranking_metrics m = judge(recall, orders[i], 1, 3);
        swap_once += m.ranking_error_swap_once / 6;
        half_l1 += m.ranking_error_half_l1 / 6;
        regret += m.regret / 6;
    }
    const vdna_ranking_metrics random = judge(recall, NULL, 1, 3);
    assert_true(fabs(random.ranking_error_swap_once - swap_once) < 1e-12);
    assert_true(fabs(random.ranking_error_half_l1 - half_l1) < 1e-12);
    assert_true(fabs(random.regret - regret) < 1e-12);
    assert_true(random.kendall_tau == 0);
}

static void tau_is_one_for_the_true_order_and_minus_one_for_its_reverse(void **state)
{
    (void)state;
    const double recall[] = {90, 60, 30, 10}, right[] = {1, 2, 3, 4}, wrong[] = {4, 3, 2, 1};
    assert_true(judge(recall, right, 1, 4).kendall_tau == 1);
    assert_true(judge(recall, wrong, 1, 4).kendall_tau == -1);
    assert_true(fabs(judge(recall, right, 1, 4).spearman_within + 1) < 1e-15);
}

static void ties_lower_tau_as_tau_b_does(void **state)
{
    (void)state;
    /* Pairs: one tied in distance, two concordant: 2 / sqrt(2 * 3). */
    const double recall[] = {90, 60, 30}, distance[] = {1, 2, 2};
    assert_true(fabs(judge(recall, distance, 1, 3).kendall_tau - 2 / sqrt(6)) < 1e-15);
}

static void correlation_is_minus_one_when_recall_falls_linearly_with_distance(void **state)
{
    (void)state;
    /* Two queries on different levels: perfect within each, less so when pooled. */
    const double recall[] = {90, 80, 70, 50, 40, 30}, distance[] = {1, 2, 3, 1, 2, 3};
    const vdna_ranking_metrics m = judge(recall, distance, 2, 3);
    assert_true(fabs(m.pearson_within + 1) < 1e-12);
    assert_true(fabs(m.spearman_within + 1) < 1e-12);
    assert_true(m.pearson_pooled > -0.6 && m.pearson_pooled < -0.3);
    assert_true(m.spearman_pooled > -0.6 && m.spearman_pooled < -0.3);
}

static void assert_nothing_is_judged(vdna_ranking_metrics m)
{
    assert_true(isnan(m.ranking_error_swap_once) && isnan(m.ranking_error_half_l1));
    assert_true(isnan(m.regret) && isnan(m.kendall_tau));
    assert_true(isnan(m.pearson_within) && isnan(m.spearman_within));
    assert_true(isnan(m.pearson_pooled) && isnan(m.spearman_pooled));
    assert_int_equal(m.queries, 0);
    assert_int_equal(m.left_out, 1);
}

static void a_truth_that_ranks_nothing_judges_no_method_and_no_chance(void **state)
{
    (void)state;
    const double one[] = {50}, equal[] = {100, 100, 100}, apart[] = {1, 2, 3};
    const double rounded[] = {100.0 / 3, 100 - 200.0 / 3, NONE};
    assert_nothing_is_judged(judge(one, apart, 1, 1));
    assert_nothing_is_judged(judge(one, NULL, 1, 1));
    assert_nothing_is_judged(judge(equal, apart, 1, 3));
    assert_nothing_is_judged(judge(equal, NULL, 1, 3));
    assert_nothing_is_judged(judge(rounded, apart, 1, 3));
}

static void queries_that_rank_nothing_are_left_out_of_every_average(void **state)
{
    (void)state;
    const double recall[] = {90, 60, 30, 0, 0, 0, 90, 60, 30};
    const double distance[] = {2, 1, 3, 7, 8, 9, 1, 2, 3};
    const double ranked[] = {90, 60, 30, 90, 60, 30}, nearer[] = {2, 1, 3, 1, 2, 3};
    const vdna_ranking_metrics m = judge(recall, distance, 3, 3), two = judge(ranked, nearer, 2, 3);
    assert_true(m.ranking_error_swap_once == 5 && m.regret == 15);
    assert_true(m.ranking_error_half_l1 == two.ranking_error_half_l1);
    assert_true(m.pearson_pooled == two.pearson_pooled);
    assert_true(m.spearman_pooled == two.spearman_pooled);
    assert_true(judge(recall, NULL, 3, 3).regret == judge(ranked, NULL, 2, 3).regret);
    assert_int_equal(m.queries, 2);
    assert_int_equal(m.left_out, 1);
}

static void a_coefficient_of_equal_distances_is_nan(void **state)
{
    (void)state;
    const double recall[] = {50, 60}, equal[] = {1, 1};
    const vdna_ranking_metrics m = judge(recall, equal, 1, 2);
    assert_true(isnan(m.kendall_tau) && isnan(m.pearson_within) && isnan(m.pearson_pooled));
    assert_true(m.regret == 10);
}

static void bad_tables_are_refused(void **state)
{
    (void)state;
    const double none[] = {NONE, NONE}, recall[] = {1, 2}, bad[] = {1, NAN};
    vdna_ranking_metrics metrics;
    const vdna_ranking_table empty = {none, recall, 1, 2}, broken = {recall, bad, 1, 2};
    const vdna_ranking_table no_queries = {recall, recall, 0, 2}, no_recall = {NULL, recall, 1, 2};
    assert_int_equal(vdna_judge_ranking(&empty, &metrics), VDNA_ERR_EMPTY);
    assert_int_equal(vdna_judge_ranking(&broken, &metrics), VDNA_ERR_NONFINITE);
    assert_int_equal(vdna_judge_ranking(&no_queries, &metrics), VDNA_ERR_ARG);
    assert_int_equal(vdna_judge_ranking(&no_recall, &metrics), VDNA_ERR_ARG);
    assert_int_equal(vdna_judge_ranking(NULL, &metrics), VDNA_ERR_ARG);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_ranking_errors_of_the_paper_are_reproduced),
        cmocka_unit_test(a_swapped_pair_counts_once_and_half_of_each_rank),
        cmocka_unit_test(a_rotation_counts_each_of_its_three_pairs),
        cmocka_unit_test(the_random_errors_are_the_means_over_all_permutations),
        cmocka_unit_test(tau_is_one_for_the_true_order_and_minus_one_for_its_reverse),
        cmocka_unit_test(ties_lower_tau_as_tau_b_does),
        cmocka_unit_test(correlation_is_minus_one_when_recall_falls_linearly_with_distance),
        cmocka_unit_test(a_truth_that_ranks_nothing_judges_no_method_and_no_chance),
        cmocka_unit_test(queries_that_rank_nothing_are_left_out_of_every_average),
        cmocka_unit_test(a_coefficient_of_equal_distances_is_nan),
        cmocka_unit_test(bad_tables_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
