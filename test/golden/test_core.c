#include <string.h>

#include <vdna/emd.h>

#include "cmocka_all.h"
#include "core_golden.h"

#define WORDS (NEURONS * (BINS + 2))

static vdna_hist count_frames(const float *activations, uint32_t frames, uint32_t mem[WORDS])
{
    vdna_hist_config config;
    vdna_hist_config_init(&config);
    config.neurons = NEURONS;
    config.bins = BINS;
    config.range = golden_range;
    vdna_hist hist;
    assert_int_equal(vdna_hist_init(&config, mem, WORDS * sizeof *mem, &hist), VDNA_OK);
    for (uint32_t f = 0; f < frames; f++) {
        const vdna_activations tap = {activations + f * NEURONS, NEURONS, 1, 0};
        assert_int_equal(vdna_hist_add(&hist, &tap, 1), VDNA_OK);
    }
    return hist;
}

static void counts_equal_those_of_the_second_implementation(void **state)
{
    (void)state;
    uint32_t mem[WORDS];
    vdna_hist hist = count_frames(golden_p, FRAMES_P, mem);
    assert_memory_equal(hist.counts, golden_counts_p, sizeof golden_counts_p);
    hist = count_frames(golden_q, FRAMES_Q, mem);
    assert_memory_equal(hist.counts, golden_counts_q, sizeof golden_counts_q);
}

static void all_frames_as_one_batch_of_samples_count_the_same(void **state)
{
    (void)state;
    uint32_t mem[WORDS];
    vdna_hist hist = count_frames(golden_p, 0, mem);
    const vdna_activations batch = {golden_p, NEURONS, FRAMES_P, VDNA_LAYOUT_SAMPLES_NEURONS};
    assert_int_equal(vdna_hist_add(&hist, &batch, 1), VDNA_OK);
    assert_memory_equal(hist.counts, golden_counts_p, sizeof golden_counts_p);
}

/* The golden distances are fractions rounded once; so are ours, hence equal to the last bit. */
static void distances_equal_the_exact_fractions(void **state)
{
    (void)state;
    uint32_t mem_p[WORDS], mem_q[WORDS];
    const vdna_hist p = count_frames(golden_p, FRAMES_P, mem_p);
    const vdna_hist q = count_frames(golden_q, FRAMES_Q, mem_q);
    vdna_hist_view view_p, view_q;
    vdna_hist_view_of(&p, &view_p);
    vdna_hist_view_of(&q, &view_q);
    int64_t scratch[2 * NEURONS];
    double emd[NEURONS];
    assert_int_equal(vdna_emd(&view_p, &view_q, scratch, sizeof scratch, emd), VDNA_OK);
    assert_memory_equal(emd, golden_emd, sizeof golden_emd);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(counts_equal_those_of_the_second_implementation),
        cmocka_unit_test(all_frames_as_one_batch_of_samples_count_the_same),
        cmocka_unit_test(distances_equal_the_exact_fractions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
