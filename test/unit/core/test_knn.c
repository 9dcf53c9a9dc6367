#include <math.h>

#include <vdna/knn.h>

#include "cmocka_all.h"

static void the_nearest_rows_come_in_order_of_distance(void **state)
{
    (void)state;
    const float map[] = {0, 0, 3, 4, 1, 0, 10, 10}, query[] = {0, 0};
    vdna_knn_match match[3];
    assert_int_equal(vdna_knn(query, 2, map, 4, 3, match), VDNA_OK);
    assert_int_equal(match[0].index, 0);
    assert_int_equal(match[1].index, 2);
    assert_int_equal(match[2].index, 1);
    assert_true(match[0].distance_sq == 0 && match[1].distance_sq == 1 &&
                match[2].distance_sq == 25);
}

static void equal_distances_go_by_the_lower_index(void **state)
{
    (void)state;
    const float map[] = {5, 1, -1, 1, -1}, query[] = {0};
    vdna_knn_match match[3];
    assert_int_equal(vdna_knn(query, 1, map, 5, 3, match), VDNA_OK);
    assert_int_equal(match[0].index, 1);
    assert_int_equal(match[1].index, 2);
    assert_int_equal(match[2].index, 3);
}

static void asking_for_more_rows_than_there_are_gives_them_all(void **state)
{
    (void)state;
    const float map[] = {2, 1}, query[] = {0};
    vdna_knn_match match[3] = {{-1, 9, 9}, {-1, 9, 9}, {-1, 9, 9}};
    assert_int_equal(vdna_knn(query, 1, map, 2, 3, match), VDNA_OK);
    assert_int_equal(match[0].index, 1);
    assert_int_equal(match[1].index, 0);
    assert_int_equal(match[2].index, 9);
}

static void every_dimension_counts_whatever_their_number(void **state)
{
    (void)state;
    enum { MOST = 40 };
    float map[MOST] = {0}, query[MOST];
    for (uint32_t dim = 1; dim <= MOST; dim++) {
        double expected = 0;
        for (uint32_t i = 0; i < dim; i++) {
            query[i] = (float)(i + 1);
            expected += (double)(i + 1) * (i + 1);
        }
        vdna_knn_match match;
        assert_int_equal(vdna_knn(query, dim, map, 1, 1, &match), VDNA_OK);
        assert_true(match.distance_sq == expected);
    }
}

/* Rows whose squared distances are integers that floats hold exactly; many are equal. */
enum { ROWS = 300, DIM = 67 };
static int32_t steps[ROWS][DIM];
static uint32_t squares[ROWS];

static void make_rows_alike(void)
{
    uint32_t random = 1;
    for (uint32_t row = 0; row < ROWS; row++) {
        squares[row] = 0;
        for (uint32_t i = 0; i < DIM; i++) {
            random = random * 1664525u + 1013904223u;
            const int32_t size = 400 - (int32_t)((i + row) % DIM) * 5;
            steps[row][i] = random >> 31 ? size : -size;
        }
        /* All rows are rotations of one row, except for one small number. */
        steps[row][(DIM - row % DIM) % DIM] = (int32_t)(random >> 8 & 7);
        for (uint32_t i = 0; i < DIM; i++)
            squares[row] += (uint32_t)(steps[row][i] * steps[row][i]);
    }
}

/* How many rows are nearer than this one, or as near and before it. */
static uint32_t rank_of(uint32_t row)
{
    uint32_t rank = 0;
    for (uint32_t other = 0; other < ROWS; other++)
        rank += squares[other] < squares[row] || (squares[other] == squares[row] && other < row);
    return rank;
}

static void rows_nearly_alike_come_in_exact_order(void **state)
{
    (void)state;
    static float map[ROWS][DIM];
    const float query[DIM] = {0};
    /* From the smallest squares that floats hold to the largest. */
    const int exponents[] = {-74, -63, -10, 0, 40, 51};
    make_rows_alike();
    for (size_t e = 0; e < sizeof exponents / sizeof *exponents; e++) {
        const double unit = ldexp(1, exponents[e]);
        for (uint32_t row = 0; row < ROWS; row++)
            for (uint32_t i = 0; i < DIM; i++)
                map[row][i] = (float)(steps[row][i] * unit);
        for (uint32_t k = 1; k <= ROWS; k = 3 * k + 1) {
            vdna_knn_match match[ROWS];
            assert_int_equal(vdna_knn(query, DIM, map[0], ROWS, k, match), VDNA_OK);
            for (uint32_t i = 0; i < k; i++) {
                assert_int_equal(rank_of(match[i].index), i);
                assert_true(match[i].distance_sq == (double)squares[match[i].index] * unit * unit);
            }
        }
    }
}

static void squares_are_within_the_promised_error(void **state)
{
    (void)state;
    enum { MOST = 3000 };
    static float map[MOST], query[MOST];
    uint32_t random = 1;
    for (uint32_t dim = 1; dim <= MOST; dim = dim * 5 / 4 + 1) {
        const double bound = (dim / 16.0 + 21) / 16777216;
        double exact = 0;
        for (uint32_t i = 0; i < dim; i++) {
            random = random * 1664525u + 1013904223u;
            map[i] = (float)random / 4294967296.0f;
            random = random * 1664525u + 1013904223u;
            query[i] = (float)random / 4294967296.0f;
            const double d = (double)query[i] - map[i];
            exact += d * d;
        }
        vdna_knn_match match;
        assert_int_equal(vdna_knn(query, dim, map, 1, 1, &match), VDNA_OK);
        assert_true(fabs(match.distance_sq - exact) <= bound * exact);
    }
}

static void a_distance_that_is_not_finite_is_refused(void **state)
{
    (void)state;
    const float good[] = {0}, bad[] = {NAN};
    vdna_knn_match match;
    assert_int_equal(vdna_knn(bad, 1, good, 1, 1, &match), VDNA_ERR_NONFINITE);
    assert_int_equal(vdna_knn(good, 1, bad, 1, 1, &match), VDNA_ERR_NONFINITE);
    const float too_far[] = {1.9e19f};
    assert_int_equal(vdna_knn(good, 1, too_far, 1, 1, &match), VDNA_ERR_NONFINITE);
    const float bad_behind_a_match[] = {0, INFINITY};
    assert_int_equal(vdna_knn(good, 1, bad_behind_a_match, 2, 1, &match), VDNA_ERR_NONFINITE);
}

static void bad_arguments_are_refused(void **state)
{
    (void)state;
    const float x[] = {0};
    vdna_knn_match match;
    assert_int_equal(vdna_knn(NULL, 1, x, 1, 1, &match), VDNA_ERR_ARG);
    assert_int_equal(vdna_knn(x, 0, x, 1, 1, &match), VDNA_ERR_ARG);
    assert_int_equal(vdna_knn(x, 1, NULL, 1, 1, &match), VDNA_ERR_ARG);
    assert_int_equal(vdna_knn(x, 1, x, 0, 1, &match), VDNA_ERR_ARG);
    assert_int_equal(vdna_knn(x, 1, x, 1, 0, &match), VDNA_ERR_ARG);
    assert_int_equal(vdna_knn(x, 1, x, 1, 1, NULL), VDNA_ERR_ARG);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_nearest_rows_come_in_order_of_distance),
        cmocka_unit_test(equal_distances_go_by_the_lower_index),
        cmocka_unit_test(asking_for_more_rows_than_there_are_gives_them_all),
        cmocka_unit_test(every_dimension_counts_whatever_their_number),
        cmocka_unit_test(rows_nearly_alike_come_in_exact_order),
        cmocka_unit_test(squares_are_within_the_promised_error),
        cmocka_unit_test(a_distance_that_is_not_finite_is_refused),
        cmocka_unit_test(bad_arguments_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
