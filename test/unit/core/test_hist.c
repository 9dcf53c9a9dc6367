#include <float.h>
#include <math.h>
#include <string.h>

#include <vdna/hist.h>

#include "cmocka_all.h"

#define BINS 4
#define NEURONS 2
#define WORDS (NEURONS * (BINS + 2))

/* Four bins of width 0.5 over -1..1, and four of width 5 over 0..20. */
static const float two_ranges[2 * NEURONS] = {-1, 1, 0, 20};

static vdna_hist_config small_config(void)
{
    vdna_hist_config config;
    vdna_hist_config_init(&config);
    config.neurons = NEURONS;
    config.bins = BINS;
    config.range = two_ranges;
    return config;
}

static vdna_hist small_hist(uint32_t mem[WORDS])
{
    const vdna_hist_config config = small_config();
    vdna_hist hist;
    assert_int_equal(vdna_hist_init(&config, mem, WORDS * sizeof *mem, &hist), VDNA_OK);
    return hist;
}

static vdna_status add_pair(vdna_hist *hist, float first, float second)
{
    const float values[NEURONS] = {first, second};
    const vdna_activations tap = {values, NEURONS, 1, VDNA_LAYOUT_SAMPLES_NEURONS};
    return vdna_hist_add(hist, &tap, 1);
}

/* The bin that one value of neuron 0 lands in. */
static uint32_t bin_of(float value)
{
    uint32_t mem[WORDS];
    vdna_hist hist = small_hist(mem);
    assert_int_equal(add_pair(&hist, value, 1), VDNA_OK);
    for (uint32_t b = 0; b < BINS; b++)
        if (hist.counts[b * NEURONS])
            return b;
    fail_msg("the value %g landed in no bin", (double)value);
    return BINS;
}

static void bins_are_half_open_and_the_last_is_closed(void **state)
{
    (void)state;
    assert_int_equal(bin_of(-1), 0);
    assert_int_equal(bin_of(-0.75f), 0);
    assert_int_equal(bin_of(nextafterf(-0.5f, -1)), 0);
    assert_int_equal(bin_of(-0.5f), 1);
    assert_int_equal(bin_of(0), 2);
    assert_int_equal(bin_of(0.5f), 3);
    assert_int_equal(bin_of(1), 3);
}

static void values_beyond_the_range_land_in_an_edge_bin_and_are_counted_as_saturated(void **state)
{
    (void)state;
    uint32_t mem[WORDS];
    vdna_hist hist = small_hist(mem);
    assert_int_equal(add_pair(&hist, -1e30f, 20), VDNA_OK);
    assert_int_equal(add_pair(&hist, 2, 21), VDNA_OK);
    assert_int_equal(hist.counts[0], 1);
    assert_int_equal(hist.counts[3 * NEURONS], 1);
    assert_int_equal(hist.counts[3 * NEURONS + 1], 2);
    assert_int_equal(hist.saturated[0], 2);
    assert_int_equal(hist.saturated[1], 1);
}

/* The definition of a bin, written a second time. */
static uint32_t defined_bin(float value, float lo, float hi, uint32_t bins)
{
    const double mid = ((double)lo + hi) / 2, half = ((double)hi - lo) / 2;
    double x = (value - mid) / half;
    x = x < -1 ? -1 : x > 1 ? 1 : x;
    const double place = (x + 1) * bins / 2;
    return place < bins ? (uint32_t)place : bins - 1;
}

/* Count samples of one neuron in the given layout and compare every count. */
static void assert_counted_as_defined(const float *values, uint32_t samples, uint32_t layout,
                                      const float *lo_hi, uint32_t bins)
{
    static uint32_t mem[VDNA_HIST_BINS_MAX + 2], expected[VDNA_HIST_BINS_MAX];
    vdna_hist_config config;
    vdna_hist_config_init(&config);
    config.neurons = 1;
    config.bins = bins;
    config.range = lo_hi;
    vdna_hist hist;
    assert_int_equal(vdna_hist_init(&config, mem, sizeof mem, &hist), VDNA_OK);
    const vdna_activations tap = {values, 1, samples, layout};
    assert_int_equal(vdna_hist_add(&hist, &tap, 1), VDNA_OK);

    memset(expected, 0, sizeof expected);
    uint32_t beyond = 0;
    for (uint32_t s = 0; s < samples; s++) {
        expected[defined_bin(values[s], lo_hi[0], lo_hi[1], bins)]++;
        const double mid = ((double)lo_hi[0] + lo_hi[1]) / 2;
        beyond += fabs((values[s] - mid) / (((double)lo_hi[1] - lo_hi[0]) / 2)) > 1;
    }
    assert_memory_equal(hist.counts, expected, bins * sizeof *expected);
    assert_int_equal(hist.saturated[0], beyond);
}

/* The middle of each bin and two floats to either side of each edge, where any arithmetic but the
 * definition's would differ. */
static void values_around_every_edge_are_counted_as_defined(void **state)
{
    (void)state;
    enum { AROUND = 6 };
    static float values[(VDNA_HIST_BINS_MAX + 1) * AROUND];
    const float ranges[][2] = {{-1, 1},
                               {0, 1},
                               {0.1f, 0.7f},
                               {-3, 1e-3f},
                               {1e6f, 1000001},
                               {16777216, 16777218},
                               {-FLT_MAX, FLT_MAX},
                               {1e-44f, 1e-40f},
                               {0, 1e-45f},
                               {1, FLT_MAX},
                               {-1e38f, 2.4e38f},
                               {-1e-30f, 0},
                               {3e-31f, 1e-29f}};
    const uint32_t some_bins[] = {2, 3, 1000, 1023, VDNA_HIST_BINS_MAX};
    for (size_t r = 0; r < sizeof ranges / sizeof *ranges; r++)
        for (size_t i = 0; i < sizeof some_bins / sizeof *some_bins; i++) {
            const uint32_t bins = some_bins[i];
            const double lo = ranges[r][0], width = (double)ranges[r][1] - lo;
            float *next = values;
            for (uint32_t b = 0; b <= bins; b++) {
                const float edge = (float)(lo + width * b / bins);
                const float below = nextafterf(edge, -FLT_MAX), above = nextafterf(edge, FLT_MAX);
                *next++ = nextafterf(below, -FLT_MAX);
                *next++ = below;
                *next++ = edge;
                *next++ = above;
                *next++ = nextafterf(above, FLT_MAX);
                *next++ = (float)(lo + width * (b < bins ? b + 0.5 : b) / bins);
            }
            const uint32_t samples = (uint32_t)(next - values);
            for (uint32_t layout = 0; layout < 2; layout++)
                assert_counted_as_defined(values, samples, layout, ranges[r], bins);
        }
}

/* More neurons than are counted together, and not a multiple of that number. */
static void wide_taps_are_counted_neuron_by_neuron(void **state)
{
    (void)state;
    enum { WIDE = 300, SAMPLES = 3 };
    static float values[WIDE * SAMPLES], range[2 * WIDE];
    static uint32_t mem[WIDE * (BINS + 2)];
    for (uint32_t n = 0; n < WIDE; n++) {
        range[2 * n] = (float)n;
        range[2 * n + 1] = (float)n + 4;
        for (uint32_t s = 0; s < SAMPLES; s++)
            values[s * WIDE + n] = (float)(n + (n + s) % 6) - 0.5f;
    }
    vdna_hist_config config = small_config();
    config.neurons = WIDE;
    config.range = range;
    vdna_hist hist;
    assert_int_equal(vdna_hist_init(&config, mem, sizeof mem, &hist), VDNA_OK);
    const vdna_activations tap = {values, WIDE, SAMPLES, VDNA_LAYOUT_SAMPLES_NEURONS};
    assert_int_equal(vdna_hist_add(&hist, &tap, 1), VDNA_OK);
    for (uint32_t n = 0; n < WIDE; n++) {
        uint32_t expected[BINS] = {0}, beyond = 0;
        for (uint32_t s = 0; s < SAMPLES; s++) {
            expected[defined_bin(values[s * WIDE + n], range[2 * n], range[2 * n + 1], BINS)]++;
            beyond += (n + s) % 6 == 0 || (n + s) % 6 == 5;
        }
        for (uint32_t b = 0; b < BINS; b++)
            assert_int_equal(hist.counts[b * WIDE + n], expected[b]);
        assert_int_equal(hist.saturated[n], beyond);
    }
}

static void counts_are_bin_major_with_a_mass_per_neuron(void **state)
{
    (void)state;
    uint32_t mem[WORDS];
    vdna_hist hist = small_hist(mem);
    assert_int_equal(add_pair(&hist, -0.9f, 19), VDNA_OK);
    assert_int_equal(add_pair(&hist, 0.1f, 19), VDNA_OK);
    const uint32_t expected[] = {1, 0, 0, 0, 1, 0, 0, 2};
    assert_memory_equal(hist.counts, expected, sizeof expected);
    assert_int_equal(hist.mass[0], 2);
    assert_int_equal(hist.mass[1], 2);
    assert_int_equal(hist.frames, 2);
}

static void both_layouts_count_the_same(void **state)
{
    (void)state;
    const float tokens[] = {-0.9f, 1, 0.1f, 6, 0.9f, 11},
                channels[] = {-0.9f, 0.1f, 0.9f, 1, 6, 11};
    const vdna_activations by_token = {tokens, 2, 3, VDNA_LAYOUT_SAMPLES_NEURONS};
    const vdna_activations by_channel = {channels, 2, 3, VDNA_LAYOUT_NEURONS_SAMPLES};
    uint32_t mem_a[WORDS], mem_b[WORDS];
    vdna_hist a = small_hist(mem_a), b = small_hist(mem_b);
    assert_int_equal(vdna_hist_add(&a, &by_token, 1), VDNA_OK);
    assert_int_equal(vdna_hist_add(&b, &by_channel, 1), VDNA_OK);
    assert_memory_equal(mem_a, mem_b, sizeof mem_a);
    assert_int_equal(a.mass[0], 3);
}

static void taps_of_different_sample_counts_share_a_histogram(void **state)
{
    (void)state;
    const float first[] = {-0.9f, 0.1f}, second[] = {19};
    const vdna_activations taps[] = {{first, 1, 2, VDNA_LAYOUT_NEURONS_SAMPLES},
                                     {second, 1, 1, VDNA_LAYOUT_SAMPLES_NEURONS}};
    uint32_t mem[WORDS];
    vdna_hist hist = small_hist(mem);
    assert_int_equal(vdna_hist_add(&hist, taps, 2), VDNA_OK);
    const uint32_t expected[] = {1, 0, 0, 0, 1, 0, 0, 1};
    assert_memory_equal(hist.counts, expected, sizeof expected);
    assert_int_equal(hist.mass[0], 2);
    assert_int_equal(hist.mass[1], 1);
    assert_int_equal(hist.frames, 1);
}

static void a_value_that_is_not_finite_rejects_the_whole_frame(void **state)
{
    (void)state;
    const float first[] = {0.5f}, bad[] = {NAN, INFINITY, -INFINITY};
    uint32_t mem[WORDS], zeros[WORDS] = {0};
    vdna_hist hist = small_hist(mem);
    for (size_t i = 0; i < 3; i++) {
        const vdna_activations taps[] = {{first, 1, 1, 0}, {bad + i, 1, 1, 0}};
        assert_int_equal(vdna_hist_add(&hist, taps, 2), VDNA_ERR_NONFINITE);
        assert_memory_equal(mem, zeros, sizeof mem);
        assert_int_equal(hist.frames, 0);
    }
}

static void taps_that_are_not_the_neurons_of_the_histogram_are_refused(void **state)
{
    (void)state;
    const float values[] = {0, 0, 0, 0};
    const vdna_activations too_few = {values, 1, 1, 0}, too_many = {values, 3, 1, 0};
    const vdna_activations no_samples = {values, 2, 0, 0}, no_values = {NULL, 2, 1, 0};
    const vdna_activations bad_layout = {values, 2, 1, 2},
                           wrapping[2] = {{values, 4, 1, 0}, {values, UINT32_MAX, 1, 0}};
    uint32_t mem[WORDS];
    vdna_hist hist = small_hist(mem);
    assert_int_equal(vdna_hist_add(&hist, &too_few, 1), VDNA_ERR_MISMATCH);
    assert_int_equal(vdna_hist_add(&hist, &too_many, 1), VDNA_ERR_MISMATCH);
    assert_int_equal(vdna_hist_add(&hist, wrapping, 2), VDNA_ERR_MISMATCH);
    assert_int_equal(vdna_hist_add(&hist, &no_samples, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_hist_add(&hist, &no_values, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_hist_add(&hist, &bad_layout, 1), VDNA_ERR_ARG);
    const vdna_activations beyond_memory = {values, UINT32_MAX, UINT32_MAX, 0};
    assert_int_equal(vdna_hist_add(&hist, &beyond_memory, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_hist_add(&hist, NULL, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_hist_add(&hist, &too_few, 0), VDNA_ERR_ARG);
    assert_int_equal(vdna_hist_add(NULL, &too_few, 1), VDNA_ERR_ARG);
}

static void a_mass_never_wraps(void **state)
{
    (void)state;
    uint32_t mem[WORDS], before[WORDS];
    vdna_hist hist = small_hist(mem);
    hist.mass[1] = UINT32_MAX;
    memcpy(before, mem, sizeof before);
    assert_int_equal(add_pair(&hist, 0, 1), VDNA_ERR_FULL);
    assert_memory_equal(mem, before, sizeof mem);

    vdna_hist_reset(&hist);
    hist.frames = UINT32_MAX;
    assert_int_equal(add_pair(&hist, 0, 1), VDNA_ERR_FULL);
}

static void merging_two_parts_equals_counting_all(void **state)
{
    (void)state;
    uint32_t mem_all[WORDS], mem_a[WORDS], mem_b[WORDS];
    vdna_hist all = small_hist(mem_all), a = small_hist(mem_a), b = small_hist(mem_b);
    for (int i = 0; i < 10; i++) {
        const float x = (float)i / 4 - 1.2f, y = (float)i * 3 - 2;
        assert_int_equal(add_pair(&all, x, y), VDNA_OK);
        assert_int_equal(add_pair(i < 3 ? &a : &b, x, y), VDNA_OK);
    }
    assert_int_equal(vdna_hist_merge(&a, &b), VDNA_OK);
    assert_memory_equal(mem_a, mem_all, sizeof mem_a);
    assert_int_equal(a.frames, 10);
}

static void subtracting_undoes_merging(void **state)
{
    (void)state;
    uint32_t mem_a[WORDS], mem_b[WORDS], before[WORDS];
    vdna_hist a = small_hist(mem_a), b = small_hist(mem_b);
    add_pair(&a, 0.3f, 7);
    add_pair(&b, -5, 30);
    memcpy(before, mem_a, sizeof before);
    assert_int_equal(vdna_hist_merge(&a, &b), VDNA_OK);
    assert_memory_not_equal(mem_a, before, sizeof before);
    assert_int_equal(vdna_hist_subtract(&a, &b), VDNA_OK);
    assert_memory_equal(mem_a, before, sizeof before);
    assert_int_equal(a.frames, 1);
}

static void subtracting_what_was_never_added_changes_nothing(void **state)
{
    (void)state;
    uint32_t mem_a[WORDS], mem_b[WORDS], before[WORDS];
    vdna_hist a = small_hist(mem_a), b = small_hist(mem_b);
    add_pair(&a, 0.3f, 7);
    add_pair(&b, 0.3f, 17);
    memcpy(before, mem_a, sizeof before);
    assert_int_equal(vdna_hist_subtract(&a, &b), VDNA_ERR_UNDERFLOW);
    assert_memory_equal(mem_a, before, sizeof before);
    b.frames = 2;
    assert_int_equal(vdna_hist_subtract(&a, &b), VDNA_ERR_UNDERFLOW);
}

static void a_sample_within_the_range_is_not_one_beyond_it(void **state)
{
    (void)state;
    uint32_t mem_a[WORDS], mem_b[WORDS], before[WORDS];
    vdna_hist beyond = small_hist(mem_a), within = small_hist(mem_b);
    add_pair(&beyond, -5, 7); /* both in the first bin */
    add_pair(&within, -0.9f, 7);
    memcpy(before, mem_a, sizeof before);
    assert_int_equal(vdna_hist_subtract(&beyond, &within), VDNA_ERR_UNDERFLOW);
    assert_memory_equal(mem_a, before, sizeof before);
    assert_int_equal(vdna_hist_subtract(&within, &beyond), VDNA_ERR_UNDERFLOW);
}

static void merging_past_the_largest_mass_is_refused(void **state)
{
    (void)state;
    uint32_t mem_a[WORDS], mem_b[WORDS];
    vdna_hist a = small_hist(mem_a), b = small_hist(mem_b);
    add_pair(&b, 0, 0);
    a.mass[1] = UINT32_MAX;
    assert_int_equal(vdna_hist_merge(&a, &b), VDNA_ERR_FULL);
    a.mass[1] = 0;
    a.frames = UINT32_MAX;
    assert_int_equal(vdna_hist_merge(&a, &b), VDNA_ERR_FULL);
}

static void histograms_of_other_ranges_or_shapes_do_not_merge(void **state)
{
    (void)state;
    const float other_ranges[2 * NEURONS] = {-1, 1, 0, 21};
    uint32_t mem_a[WORDS], mem_b[WORDS];
    vdna_hist a = small_hist(mem_a), b = small_hist(mem_b);
    b.range = other_ranges;
    assert_int_equal(vdna_hist_merge(&a, &b), VDNA_ERR_MISMATCH);
    assert_int_equal(vdna_hist_subtract(&a, &b), VDNA_ERR_MISMATCH);
    b = small_hist(mem_b);
    b.bins = 3;
    assert_int_equal(vdna_hist_merge(&a, &b), VDNA_ERR_MISMATCH);
    assert_int_equal(vdna_hist_merge(&a, NULL), VDNA_ERR_ARG);
}

static void histograms_compare_if_shape_and_range_agree_and_no_neuron_is_empty(void **state)
{
    (void)state;
    const float same_ranges[2 * NEURONS] = {-1, 1, 0, 20}, others[2 * NEURONS] = {-1, 1, 0, 21};
    uint32_t mem_a[WORDS], mem_b[WORDS];
    vdna_hist a = small_hist(mem_a), b = small_hist(mem_b);
    add_pair(&a, 0, 1);
    vdna_hist_view p, q;
    vdna_hist_view_of(&a, &p);
    vdna_hist_view_of(&b, &q);
    assert_int_equal(vdna_hist_view_check_pair(&p, &p), VDNA_OK);
    assert_int_equal(vdna_hist_view_check_pair(&p, &q), VDNA_ERR_EMPTY);
    assert_int_equal(vdna_hist_view_check_pair(&q, &p), VDNA_ERR_EMPTY);
    add_pair(&b, 1, 0);
    q.range = same_ranges;
    assert_int_equal(vdna_hist_view_check_pair(&p, &q), VDNA_OK);
    q.range = others;
    assert_int_equal(vdna_hist_view_check_pair(&p, &q), VDNA_ERR_MISMATCH);
    q = p;
    q.bins = BINS - 1;
    assert_int_equal(vdna_hist_view_check_pair(&p, &q), VDNA_ERR_MISMATCH);
    q = p;
    q.neurons = 0;
    assert_int_equal(vdna_hist_view_check_pair(&p, &q), VDNA_ERR_ARG);
    q = p;
    q.bins = VDNA_HIST_BINS_MAX + 1;
    assert_int_equal(vdna_hist_view_check_pair(&q, &p), VDNA_ERR_ARG);
    assert_int_equal(vdna_hist_view_check_pair(&p, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_hist_view_check_pair(NULL, &p), VDNA_ERR_ARG);
}

static void the_mean_bin_of_a_neuron_is_that_of_its_samples(void **state)
{
    (void)state;
    static const float range[][2] = {{0, 1}, {0, 1}};
    const uint32_t counts[][2] = {{1, 0}, {0, 0}, {0, 0}, {3, 0}}, mass[] = {4, 0};
    const vdna_hist_view view = {range[0], counts[0], mass, 2, 4};
    vdna_hist_view invalid = view;
    invalid.bins = 0;
    double bin = 0;
    assert_int_equal(vdna_hist_view_mean(&view, 0, &bin), VDNA_OK);
    assert_true(bin == 2.25);
    assert_int_equal(vdna_hist_view_mean(&view, 1, &bin), VDNA_ERR_EMPTY);
    assert_int_equal(vdna_hist_view_mean(&view, 2, &bin), VDNA_ERR_ARG);
    assert_int_equal(vdna_hist_view_mean(&invalid, 0, &bin), VDNA_ERR_ARG);
    assert_int_equal(vdna_hist_view_mean(&view, 0, NULL), VDNA_ERR_ARG);
    assert_true(bin == 2.25);
}

static void the_block_may_not_be_a_byte_too_small_nor_misaligned(void **state)
{
    (void)state;
    const vdna_hist_config config = small_config();
    uint32_t mem[WORDS + 1];
    vdna_hist hist;
    assert_int_equal(vdna_hist_mem_size(&config), WORDS * sizeof *mem);
    assert_int_equal(vdna_hist_init(&config, mem, WORDS * sizeof *mem - 1, &hist), VDNA_ERR_NOMEM);
    assert_int_equal(vdna_hist_init(&config, (char *)mem + 1, WORDS * sizeof *mem, &hist),
                     VDNA_ERR_ARG);
    assert_int_equal(vdna_hist_init(&config, NULL, WORDS * sizeof *mem, &hist), VDNA_ERR_ARG);
}

static void bad_shapes_have_no_size(void **state)
{
    (void)state;
    vdna_hist_config config = small_config();
    config.neurons = 0;
    assert_int_equal(vdna_hist_mem_size(&config), 0);
    config = small_config();
    config.bins = 1;
    assert_int_equal(vdna_hist_mem_size(&config), 0);
    config.bins = VDNA_HIST_BINS_MAX + 1;
    assert_int_equal(vdna_hist_mem_size(&config), 0);
    config = small_config();
    config.struct_size = 0;
    assert_int_equal(vdna_hist_mem_size(&config), 0);
    config.struct_size = sizeof config - 1;
    assert_int_equal(vdna_hist_mem_size(&config), 0);
    config.struct_size = sizeof config + 1;
    assert_int_equal(vdna_hist_mem_size(&config), 0);
    assert_int_equal(vdna_hist_mem_size(NULL), 0);
}

static void a_range_without_width_is_refused(void **state)
{
    (void)state;
    const float flat[2 * NEURONS] = {-1, 1, 3, 3};
    vdna_hist_config config = small_config();
    config.range = flat;
    uint32_t mem[WORDS];
    vdna_hist hist;
    assert_int_equal(vdna_hist_init(&config, mem, sizeof mem, &hist), VDNA_ERR_ARG);
    config.range = NULL;
    assert_int_equal(vdna_hist_init(&config, mem, sizeof mem, &hist), VDNA_ERR_ARG);
}

static void defaults_are_a_thousand_bins_and_no_neurons(void **state)
{
    (void)state;
    vdna_hist_config config;
    vdna_hist_config_init(&config);
    assert_int_equal(config.bins, 1000);
    assert_int_equal(config.neurons, 0);
    assert_int_equal(config.struct_size, sizeof config);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bins_are_half_open_and_the_last_is_closed),
        cmocka_unit_test(values_beyond_the_range_land_in_an_edge_bin_and_are_counted_as_saturated),
        cmocka_unit_test(values_around_every_edge_are_counted_as_defined),
        cmocka_unit_test(wide_taps_are_counted_neuron_by_neuron),
        cmocka_unit_test(counts_are_bin_major_with_a_mass_per_neuron),
        cmocka_unit_test(both_layouts_count_the_same),
        cmocka_unit_test(taps_of_different_sample_counts_share_a_histogram),
        cmocka_unit_test(a_value_that_is_not_finite_rejects_the_whole_frame),
        cmocka_unit_test(taps_that_are_not_the_neurons_of_the_histogram_are_refused),
        cmocka_unit_test(a_mass_never_wraps),
        cmocka_unit_test(merging_two_parts_equals_counting_all),
        cmocka_unit_test(subtracting_undoes_merging),
        cmocka_unit_test(subtracting_what_was_never_added_changes_nothing),
        cmocka_unit_test(a_sample_within_the_range_is_not_one_beyond_it),
        cmocka_unit_test(merging_past_the_largest_mass_is_refused),
        cmocka_unit_test(histograms_of_other_ranges_or_shapes_do_not_merge),
        cmocka_unit_test(histograms_compare_if_shape_and_range_agree_and_no_neuron_is_empty),
        cmocka_unit_test(the_mean_bin_of_a_neuron_is_that_of_its_samples),
        cmocka_unit_test(the_block_may_not_be_a_byte_too_small_nor_misaligned),
        cmocka_unit_test(bad_shapes_have_no_size),
        cmocka_unit_test(a_range_without_width_is_refused),
        cmocka_unit_test(defaults_are_a_thousand_bins_and_no_neurons),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
