#include <math.h>

#include <vdna/baseline.h>

#include "cmocka_all.h"

static double distance_of(const float *a, uint32_t frames_a, const float *b, uint32_t frames_b,
                          uint32_t dim)
{
    double distance = -1;
    assert_int_equal(vdna_frechet(a, frames_a, b, frames_b, dim, &distance), VDNA_OK);
    return distance;
}

/* In one dimension the distance is (m1 - m2)^2 + (s1 - s2)^2. */
static void one_dimension_agrees_with_the_closed_form(void **state)
{
    (void)state;
    const float a[] = {0, 2}, b[] = {5, 9};
    const double s1 = sqrt(2), s2 = sqrt(8);
    assert_true(fabs(distance_of(a, 2, b, 2, 1) - (36 + (s1 - s2) * (s1 - s2))) < 1e-12);
}

/* Orthogonal spreads have a product of zero: nothing is taken off the traces. */
static void orthogonal_spreads_add_up(void **state)
{
    (void)state;
    const float along_x[] = {-1, 0, 1, 0}, along_y[] = {0, -3, 0, 3};
    assert_true(fabs(distance_of(along_x, 2, along_y, 2, 2) - (2 + 18)) < 1e-12);
}

static void a_set_is_at_distance_zero_from_itself_even_if_singular(void **state)
{
    (void)state;
    /* Three frames in eight dimensions. */
    float a[3 * 8];
    for (int i = 0; i < 24; i++)
        a[i] = (float)((i * 37 + 11) % 23) - 11;
    assert_true(distance_of(a, 3, a, 3, 8) < 1e-11);
}

static void the_distance_is_symmetric_whatever_the_numbers_of_frames(void **state)
{
    (void)state;
    float a[2 * 3], b[9 * 3];
    for (int i = 0; i < 6; i++)
        a[i] = (float)((i * 5 + 2) % 7);
    for (int i = 0; i < 27; i++)
        b[i] = (float)((i * 11 + 4) % 13);
    const double forth = distance_of(a, 2, b, 9, 3), back = distance_of(b, 9, a, 2, 3);
    assert_true(forth > 0 && fabs(forth - back) < 1e-12 * forth);
}

static void bad_input_is_refused(void **state)
{
    (void)state;
    const float good[] = {1, 2}, bad[] = {1, INFINITY};
    double distance = -1;
    assert_int_equal(vdna_frechet(good, 1, good, 2, 1, &distance), VDNA_ERR_ARG);
    assert_int_equal(vdna_frechet(good, 2, good, 2, 0, &distance), VDNA_ERR_ARG);
    assert_int_equal(vdna_frechet(NULL, 2, good, 2, 1, &distance), VDNA_ERR_ARG);
    assert_int_equal(vdna_frechet(good, 2, good, 2, 1, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_frechet(good, 2, bad, 2, 1, &distance), VDNA_ERR_NONFINITE);
    assert_true(distance == -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_dimension_agrees_with_the_closed_form),
        cmocka_unit_test(orthogonal_spreads_add_up),
        cmocka_unit_test(a_set_is_at_distance_zero_from_itself_even_if_singular),
        cmocka_unit_test(the_distance_is_symmetric_whatever_the_numbers_of_frames),
        cmocka_unit_test(bad_input_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
