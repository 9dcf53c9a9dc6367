#include <float.h>
#include <math.h>
#include <string.h>

#include <vdna/int8.h>

#include "cmocka_all.h"

#define SMALLEST 0x1p-149f

static void the_largest_magnitude_is_127_steps_and_halves_round_away_from_zero(void **state)
{
    (void)state;
    const float values[] = {-254, 254, 1, -1, 0.99f, -5, 0, 128};
    const int8_t expected[] = {-127, 127, 1, -1, 0, -3, 0, 64};
    int8_t codes[8];
    float scale, decoded[8];
    assert_int_equal(vdna_int8_encode(values, 8, codes, &scale), VDNA_OK);
    assert_true(scale == 2);
    assert_memory_equal(codes, expected, sizeof codes);
    assert_int_equal(vdna_int8_decode(codes, 8, scale, decoded), VDNA_OK);
    assert_true(decoded[0] == -254 && decoded[5] == -6 && decoded[7] == 128);
}

static void a_number_comes_back_within_half_a_scale(void **state)
{
    (void)state;
    float values[500], decoded[500], scale;
    int8_t codes[500];
    for (int i = 0; i < 500; i++)
        values[i] = 6 * sinf((float)(i * i));
    assert_int_equal(vdna_int8_encode(values, 500, codes, &scale), VDNA_OK);
    assert_int_equal(vdna_int8_decode(codes, 500, scale, decoded), VDNA_OK);
    for (int i = 0; i < 500; i++)
        assert_true(fabsf(values[i] - decoded[i]) <= scale * 0.500001f);
}

static void rows_without_a_scale_are_all_zero(void **state)
{
    (void)state;
    const float zeros[] = {0, -0.0f}, tiny[] = {SMALLEST, -SMALLEST};
    int8_t codes[2] = {7, 7};
    float scale = 7;
    assert_int_equal(vdna_int8_encode(zeros, 2, codes, &scale), VDNA_OK);
    assert_true(codes[0] == 0 && codes[1] == 0 && scale == 0);
    codes[0] = codes[1] = 7;
    assert_int_equal(vdna_int8_encode(tiny, 2, codes, &scale), VDNA_OK);
    assert_true(codes[0] == 0 && codes[1] == 0 && scale == 0);
}

static void a_coarse_scale_does_not_carry_a_code_beyond_127(void **state)
{
    (void)state;
    /* 190 of the smallest float: the scale is 1.496 of it, rounded to one. */
    const float values[] = {190 * SMALLEST, -190 * SMALLEST};
    int8_t codes[2];
    float scale;
    assert_int_equal(vdna_int8_encode(values, 2, codes, &scale), VDNA_OK);
    assert_true(scale == SMALLEST);
    assert_true(codes[0] == 127 && codes[1] == -127);
}

static void the_largest_floats_come_back_as_well(void **state)
{
    (void)state;
    const float values[] = {FLT_MAX, -FLT_MAX / 4};
    int8_t codes[2];
    float scale, decoded[2];
    assert_int_equal(vdna_int8_encode(values, 2, codes, &scale), VDNA_OK);
    assert_true(codes[0] == 127 && codes[1] == -32);
    assert_int_equal(vdna_int8_decode(codes, 2, scale, decoded), VDNA_OK);
    for (int i = 0; i < 2; i++) /* finite, too */
        assert_true(fabs((double)decoded[i] - values[i]) <= 0.500001 * (double)scale);
}

static void what_is_no_number_is_refused_and_nothing_is_written(void **state)
{
    (void)state;
    const float bad[][3] = {{1, NAN, 2}, {1, 2, INFINITY}, {-INFINITY, 0, 0}};
    int8_t codes[3] = {7, 7, 7};
    float scale = 7;
    for (size_t i = 0; i < 3; i++)
        assert_int_equal(vdna_int8_encode(bad[i], 3, codes, &scale), VDNA_ERR_NONFINITE);
    assert_true(codes[0] == 7 && scale == 7);
    assert_int_equal(vdna_int8_encode(NULL, 3, codes, &scale), VDNA_ERR_ARG);
    assert_int_equal(vdna_int8_encode(bad[0], 0, codes, &scale), VDNA_ERR_ARG);
    assert_int_equal(vdna_int8_encode(bad[0], 3, NULL, &scale), VDNA_ERR_ARG);
    assert_int_equal(vdna_int8_encode(bad[0], 3, codes, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_int8_decode(NULL, 3, 1, &scale), VDNA_ERR_ARG);
    assert_int_equal(vdna_int8_decode(codes, 0, 1, &scale), VDNA_ERR_ARG);
    assert_int_equal(vdna_int8_decode(codes, 3, 1, NULL), VDNA_ERR_ARG);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_largest_magnitude_is_127_steps_and_halves_round_away_from_zero),
        cmocka_unit_test(a_number_comes_back_within_half_a_scale),
        cmocka_unit_test(rows_without_a_scale_are_all_zero),
        cmocka_unit_test(a_coarse_scale_does_not_carry_a_code_beyond_127),
        cmocka_unit_test(the_largest_floats_come_back_as_well),
        cmocka_unit_test(what_is_no_number_is_refused_and_nothing_is_written),
    };
    return cmocka_run_group_tests_name("int8", tests, NULL, NULL);
}
