#include <math.h>

#include <vdna/baseline.h>

#include "cmocka_all.h"
#include "frechet_golden.h"

/* SciPy takes a matrix root, we take singular values: their rounding errors differ. */
static void full_rank_distances_agree_with_scipy(void **state)
{
    (void)state;
    double distance;
    assert_int_equal(vdna_frechet(golden_a, FRAMES_A, golden_b, FRAMES_B, DIM, &distance), VDNA_OK);
    assert_true(fabs(distance - golden_distance) <= 1e-9 * golden_distance);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(full_rank_distances_agree_with_scipy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
