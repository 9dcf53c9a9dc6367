#include <math.h>
#include <stdlib.h>
#include <string.h>

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

/* ---- The nearest by codes ---- */

static uint32_t seed = 1;

/* -1..1 */
static float random_number(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (float)(int32_t)seed / 2147483648.0f;
}

static void *codes_of(const float *map, uint32_t dim, uint32_t rows)
{
    const size_t size = vdna_knn_codes_size(dim, rows);
    void *const codes = malloc(size);
    assert_non_null(codes);
    assert_int_equal(vdna_knn_encode(map, dim, rows, codes, size), VDNA_OK);
    return codes;
}

static void assert_as_without_codes(const float *query, uint32_t dim, const float *map,
                                    uint32_t rows, const void *codes)
{
    vdna_knn_match found, expected;
    const vdna_status status = vdna_knn(query, dim, map, rows, 1, &expected);
    assert_int_equal(vdna_knn_nearest(query, dim, map, rows, codes, &found), status);
    if (status == VDNA_OK)
        assert_memory_equal(&found, &expected, sizeof found);
}

/* A route: each row is like the one before. */
static void fill_route(float *map, uint32_t dim, uint32_t rows, double unit)
{
    for (size_t i = 0; i < (size_t)dim * rows; i++) {
        const float before = i < dim ? random_number() : map[i - dim];
        map[i] = i < dim ? (float)(before * unit) : (float)(before + 0.2 * random_number() * unit);
    }
}

static void codes_change_no_bit_of_the_nearest(void **state)
{
    (void)state;
    enum { MOST_ROWS = 1100, MOST_DIM = 300 };
    static float map[MOST_ROWS * MOST_DIM], query[MOST_DIM];
    const double units[] = {1e-44, 1e-33, 1e-20, 1e-9, 1, 1e12};
    const uint32_t dims[] = {1, 2, 15, 16, 33, MOST_DIM}, rows[] = {1, 2, 16, 17, 33, MOST_ROWS};
    for (size_t u = 0; u < sizeof units / sizeof *units; u++)
        for (size_t shape = 0; shape < 36; shape++) {
            const uint32_t dim = dims[shape % 6], count = rows[shape / 6];
            fill_route(map, dim, count, units[u]);
            void *const codes = codes_of(map, dim, count);
            for (uint32_t q = 0; q < 12; q++) {
                const float *row = map + (size_t)(q * 7919u % count) * dim;
                const double noise = q < 4 ? 0 : q < 8 ? 0.3 : 30;
                for (uint32_t i = 0; i < dim; i++)
                    query[i] = (float)(row[i] + noise * random_number() * units[u]);
                assert_as_without_codes(query, dim, map, count, codes);
            }
            free(codes);
        }
}

static void of_equal_rows_the_first_is_found_by_codes_too(void **state)
{
    (void)state;
    const float query[] = {0};
    for (uint32_t equal = 0; equal < 40; equal++) {
        float map[40];
        for (uint32_t row = 0; row < 40; row++)
            map[row] = row >= equal ? (row & 1 ? 1.0f : -1.0f) : 2;
        void *const codes = codes_of(map, 1, 40);
        vdna_knn_match match;
        assert_int_equal(vdna_knn_nearest(query, 1, map, 40, codes, &match), VDNA_OK);
        assert_int_equal(match.index, equal);
        free(codes);
    }
}

static void rows_nearly_alike_are_told_apart_in_spite_of_codes(void **state)
{
    (void)state;
    static float map[ROWS][DIM];
    const float query[DIM] = {0};
    make_rows_alike();
    for (uint32_t row = 0; row < ROWS; row++)
        for (uint32_t i = 0; i < DIM; i++)
            map[row][i] = (float)steps[row][i];
    void *const codes = codes_of(map[0], DIM, ROWS);
    vdna_knn_match match;
    assert_int_equal(vdna_knn_nearest(query, DIM, map[0], ROWS, codes, &match), VDNA_OK);
    assert_int_equal(rank_of(match.index), 0);
    free(codes);
}

static void a_query_beyond_codes_is_answered_without_them(void **state)
{
    (void)state;
    const float map[] = {0, 1, 2, 3};
    void *const codes = codes_of(map, 1, 4);
    const float queries[] = {1e16f, -3e18f, 1.9e19f, INFINITY, NAN};
    for (size_t q = 0; q < sizeof queries / sizeof *queries; q++)
        assert_as_without_codes(&queries[q], 1, map, 4, codes);
    assert_as_without_codes(map, 1, map, 4, NULL);
    free(codes);

    enum { LONG = 5000 };
    static const float zeros[2 * LONG];
    assert_int_equal(vdna_knn_codes_size(LONG, 2), 0);
    assert_as_without_codes(zeros, LONG, zeros, 2, zeros);
}

static void what_has_no_codes_is_refused(void **state)
{
    (void)state;
    const float good[] = {1, 2}, too_long[] = {0, 1.1e15f}, bad[] = {1, NAN};
    double mem[8];
    const size_t size = vdna_knn_codes_size(1, 2);
    assert_true(size > 0 && size < sizeof mem);
    assert_int_equal(vdna_knn_codes_size(0, 2), 0);
    assert_int_equal(vdna_knn_codes_size(1, 0), 0);
    assert_int_equal(vdna_knn_encode(NULL, 1, 2, mem, size), VDNA_ERR_ARG);
    assert_int_equal(vdna_knn_encode(good, 1, 2, NULL, size), VDNA_ERR_ARG);
    assert_int_equal(vdna_knn_encode(good, 0, 2, mem, size), VDNA_ERR_ARG);
    assert_int_equal(vdna_knn_encode(good, 1, 2, (char *)mem + 4, size), VDNA_ERR_ARG);
    assert_int_equal(vdna_knn_encode(good, 1, 2, mem, size - 1), VDNA_ERR_NOMEM);
    assert_int_equal(vdna_knn_encode(too_long, 1, 2, mem, size), VDNA_ERR_NONFINITE);
    assert_int_equal(vdna_knn_encode(bad, 1, 2, mem, size), VDNA_ERR_NONFINITE);
    assert_int_equal(vdna_knn_encode(good, 1, 2, mem, size), VDNA_OK);

    vdna_knn_match match;
    assert_int_equal(vdna_knn_nearest(NULL, 1, good, 2, mem, &match), VDNA_ERR_ARG);
    assert_int_equal(vdna_knn_nearest(good, 1, NULL, 2, mem, &match), VDNA_ERR_ARG);
    assert_int_equal(vdna_knn_nearest(good, 1, good, 2, mem, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_knn_nearest(good, 0, good, 2, mem, &match), VDNA_ERR_ARG);
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
        cmocka_unit_test(codes_change_no_bit_of_the_nearest),
        cmocka_unit_test(of_equal_rows_the_first_is_found_by_codes_too),
        cmocka_unit_test(rows_nearly_alike_are_told_apart_in_spite_of_codes),
        cmocka_unit_test(a_query_beyond_codes_is_answered_without_them),
        cmocka_unit_test(what_has_no_codes_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
