#include <math.h>
#include <string.h>

#include <vdna/emd.h>

#include "cmocka_all.h"
#include "reference_golden.h"

static float range[2 * NEURONS];
static uint32_t counts[2][BINS * NEURONS], mass[2][NEURONS];

/* As in make_reference.py. */
static uint32_t count_of(uint32_t side, uint32_t neuron, uint32_t b)
{
    const uint32_t noise = (b * 2654435761u + neuron * 40503u + side * 97003u) >> 16;
    const int centre = (int)(150 + 90 * neuron + 40 * side * (neuron % 4));
    const int away = (int)b > centre ? (int)b - centre : centre - (int)b;
    return away < (int)(120 + 10 * neuron) ? noise % 50 : noise % 97 == 0;
}

static vdna_hist_view dna_of(uint32_t side)
{
    memset(mass[side], 0, sizeof mass[side]);
    for (uint32_t n = 0; n < NEURONS; n++) {
        range[2 * n + 1] = 1;
        for (uint32_t b = 0; b < BINS; b++) {
            const uint32_t count = count_of(n == NEURONS - 1 ? 0 : side, n, b);
            counts[side][b * NEURONS + n] = count;
            mass[side][n] += count;
        }
    }
    const vdna_hist_view view = {range, counts[side], mass[side], NEURONS, BINS};
    return view;
}

static void assert_close(double ours, double reference)
{
    assert_true(fabs(ours - reference) <= 1e-12 * reference);
}

static void distances_agree_with_the_reference_package(void **state)
{
    (void)state;
    const vdna_hist_view p = dna_of(0), q = dna_of(1);
    int64_t scratch[2 * NEURONS];
    double emd[NEURONS], mean;
    assert_int_equal(vdna_emd(&p, &q, scratch, sizeof scratch, emd), VDNA_OK);
    for (size_t n = 0; n < NEURONS; n++)
        assert_close(emd[n], golden_emd[n]);
    assert_int_equal(vdna_emd_mean(&p, &q, scratch, sizeof scratch, &mean), VDNA_OK);
    assert_close(mean, golden_mean);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distances_agree_with_the_reference_package),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
