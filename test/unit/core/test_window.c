#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <vdna/window.h>

#include "cmocka_all.h"

/* One neuron with four bins over 0..4, one sample a frame. */
#define BINS 4
static const float range[] = {0, 4};
static const vdna_activations one_sample[] = {{NULL, 1, 1, VDNA_LAYOUT_SAMPLES_NEURONS}};
static int64_t block[64];

static vdna_window_config by_frames(uint32_t frames)
{
    vdna_window_config config;
    vdna_window_config_init(&config);
    config.capacity = frames;
    config.taps = one_sample;
    config.tap_count = 1;
    config.range = range;
    config.bins = BINS;
    return config;
}

static vdna_window_config by_time(int64_t length_us, uint32_t capacity)
{
    vdna_window_config config = by_frames(capacity);
    config.length_us = length_us;
    return config;
}

static vdna_window window_of(vdna_window_config config)
{
    vdna_window window;
    assert_int_equal(vdna_window_init(&config, block, sizeof block, &window), VDNA_OK);
    return window;
}

static vdna_status try_add(vdna_window *window, int64_t utime, float value)
{
    const vdna_activations tap = {&value, 1, 1, VDNA_LAYOUT_SAMPLES_NEURONS};
    return vdna_window_add(window, utime, &tap, 1);
}

static void add(vdna_window *window, int64_t utime, float value)
{
    assert_int_equal(try_add(window, utime, value), VDNA_OK);
}

static void assert_counts(const vdna_window *window, uint32_t c0, uint32_t c1, uint32_t c2,
                          uint32_t c3, uint32_t saturated)
{
    const uint32_t counts[BINS] = {c0, c1, c2, c3};
    assert_memory_equal(window->hist.counts, counts, sizeof counts);
    assert_int_equal(window->hist.mass[0], c0 + c1 + c2 + c3);
    assert_int_equal(window->hist.frames, c0 + c1 + c2 + c3);
    assert_int_equal(window->hist.saturated[0], saturated);
}

static void by_frames_the_oldest_leaves_when_the_window_is_full(void **state)
{
    (void)state;
    vdna_window window = window_of(by_frames(2));
    assert_counts(&window, 0, 0, 0, 0, 0);
    add(&window, 10, 0.5f);
    assert_counts(&window, 1, 0, 0, 0, 0);
    add(&window, 20, 1.5f);
    assert_counts(&window, 1, 1, 0, 0, 0);
    add(&window, 30, 2.5f);
    assert_counts(&window, 0, 1, 1, 0, 0);
    assert_int_equal(window.first_utime, 20);
    assert_int_equal(window.last_utime, 30);
    assert_int_equal(window.truncated, 0);
    assert_int_equal(window.left_early, 0);
}

static void what_lay_beyond_the_range_leaves_as_such(void **state)
{
    (void)state;
    vdna_window window = window_of(by_frames(2));
    add(&window, 0, -1);
    add(&window, 1, 5);
    assert_counts(&window, 1, 0, 0, 1, 2);
    add(&window, 2, 0);
    assert_counts(&window, 1, 0, 0, 1, 1);
    add(&window, 3, 4);
    assert_counts(&window, 1, 0, 0, 1, 0);
}

static void by_time_a_frame_leaves_when_it_is_as_old_as_the_window_is_long(void **state)
{
    (void)state;
    vdna_window window = window_of(by_time(1000, 8));
    add(&window, 5000, 0.5f);
    add(&window, 5999, 1.5f);
    assert_counts(&window, 1, 1, 0, 0, 0);
    add(&window, 6000, 2.5f);
    assert_counts(&window, 0, 1, 1, 0, 0);
    assert_int_equal(window.first_utime, 5999);
    add(&window, 90000, 3.5f);
    assert_counts(&window, 0, 0, 0, 1, 0);
    assert_int_equal(window.first_utime, 90000);
    assert_int_equal(window.left_early, 0);
}

static void more_frames_than_capacity_within_the_time_leave_early_and_that_shows(void **state)
{
    (void)state;
    vdna_window window = window_of(by_time(1000, 2));
    add(&window, 0, 0.5f);
    add(&window, 400, 1.5f);
    assert_int_equal(window.truncated, 0);
    add(&window, 800, 2.5f);
    assert_counts(&window, 0, 1, 1, 0, 0);
    assert_int_equal(window.truncated, 1);
    assert_int_equal(window.left_early, 1);
    assert_int_equal(window.left_utime, 0);

    /* The frame of 0 would still belong to a window that ends at 999, but not at 1400, when the
     * one of 400 is due as well. */
    add(&window, 1400, 3.5f);
    assert_counts(&window, 0, 0, 1, 1, 0);
    assert_int_equal(window.truncated, 0);
    assert_int_equal(window.left_early, 1);
}

static void a_stamp_that_runs_backwards_empties_the_window_first(void **state)
{
    (void)state;
    for (int time = 0; time < 2; time++) {
        vdna_window window = window_of(time ? by_time(1000, 3) : by_frames(3));
        add(&window, 500, 0.5f);
        add(&window, 500, 1.5f);
        assert_int_equal(window.restarts, 0);
        add(&window, 499, 2.5f);
        assert_counts(&window, 0, 0, 1, 0, 0);
        assert_int_equal(window.restarts, 1);
        assert_int_equal(window.first_utime, 499);
        assert_int_equal(window.truncated, 0);
    }
}

static void the_furthest_stamps_are_far_apart(void **state)
{
    (void)state;
    vdna_window window = window_of(by_time(1000, 3));
    add(&window, INT64_MIN, 0.5f);
    add(&window, INT64_MAX, 1.5f);
    assert_counts(&window, 0, 1, 0, 0, 0);
    add(&window, INT64_MIN, 2.5f);
    assert_counts(&window, 0, 0, 1, 0, 0);
    assert_int_equal(window.restarts, 1);
}

static void a_refused_frame_changes_nothing(void **state)
{
    (void)state;
    vdna_window window = window_of(by_time(1000, 2));
    add(&window, 0, 0.5f);
    add(&window, 10, 1.5f);
    int64_t before[64];
    const vdna_window copy = window;
    memcpy(before, block, sizeof before);

    const float values[] = {1, 2};
    const vdna_activations two_samples = {values, 1, 2, 0}, two_neurons = {values, 2, 1, 0};
    const vdna_activations other_layout = {values, 1, 1, VDNA_LAYOUT_NEURONS_SAMPLES};
    const vdna_activations none = {NULL, 1, 1, 0};
    assert_int_equal(try_add(&window, 2000, NAN), VDNA_ERR_NONFINITE);
    assert_int_equal(vdna_window_add(&window, 2000, &two_samples, 1), VDNA_ERR_MISMATCH);
    assert_int_equal(vdna_window_add(&window, 2000, &two_neurons, 1), VDNA_ERR_MISMATCH);
    assert_int_equal(vdna_window_add(&window, 2000, &other_layout, 1), VDNA_ERR_MISMATCH);
    assert_int_equal(vdna_window_add(&window, 2000, &none, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_window_add(&window, 2000, NULL, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_window_add(NULL, 2000, &two_samples, 1), VDNA_ERR_ARG);
    assert_memory_equal(block, before, sizeof before);
    assert_memory_equal(&window, &copy, sizeof copy);
}

static void taps_of_the_same_total_but_another_division_are_refused(void **state)
{
    (void)state;
    const float ranges[] = {0, 4, 0, 4, 0, 4}, values[] = {1, 2, 3};
    const vdna_activations two[] = {{values, 1, 1, 0}, {values, 2, 1, 0}}, one = {values, 3, 1, 0};
    const vdna_activations swapped[] = {two[1], two[0]};
    vdna_window_config config = by_frames(2);
    config.taps = two;
    config.tap_count = 2;
    config.range = ranges;
    vdna_window window = window_of(config);
    assert_int_equal(vdna_window_add(&window, 0, &one, 1), VDNA_ERR_MISMATCH);
    assert_int_equal(vdna_window_add(&window, 0, swapped, 2), VDNA_ERR_MISMATCH);
    assert_int_equal(vdna_window_add(&window, 0, two, 2), VDNA_OK);
}

static void a_reset_window_is_empty_and_keeps_its_counters(void **state)
{
    (void)state;
    vdna_window window = window_of(by_time(1000, 1));
    add(&window, 0, 0.5f);
    add(&window, 1, 0.5f);
    assert_int_equal(window.truncated, 1);
    vdna_window_reset(&window);
    assert_counts(&window, 0, 0, 0, 0, 0);
    assert_int_equal(window.truncated, 0);
    assert_int_equal(window.left_early, 1);
    /* Also with an earlier stamp: the old frames are forgotten. */
    add(&window, -7, 3.5f);
    assert_counts(&window, 0, 0, 0, 1, 0);
    assert_int_equal(window.restarts, 0);
    vdna_window_reset(NULL);
}

static void the_block_may_not_be_a_byte_too_small_nor_misaligned(void **state)
{
    (void)state;
    const vdna_window_config config = by_frames(3);
    const size_t size = vdna_window_mem_size(&config);
    vdna_window window;
    assert_int_equal(size, 3 * 8 + (BINS + 2) * 4 + 3 * 2);
    assert_int_equal(vdna_window_init(&config, block, size - 1, &window), VDNA_ERR_NOMEM);
    assert_int_equal(vdna_window_init(&config, (char *)block + 4, size, &window), VDNA_ERR_ARG);
    assert_int_equal(vdna_window_init(&config, NULL, size, &window), VDNA_ERR_ARG);
    assert_int_equal(vdna_window_init(&config, block, size, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_window_init(&config, block, size, &window), VDNA_OK);
}

static void bad_configs_have_no_size(void **state)
{
    (void)state;
    vdna_window_config config = by_frames(0);
    assert_int_equal(vdna_window_mem_size(&config), 0);
    config = by_time(-1, 2);
    assert_int_equal(vdna_window_mem_size(&config), 0);
    config = by_frames(1);
    config.bins = VDNA_WINDOW_BINS_MAX + 1;
    assert_int_equal(vdna_window_mem_size(&config), 0);
    config.bins = 1;
    assert_int_equal(vdna_window_mem_size(&config), 0);
    config = by_frames(1);
    config.taps = NULL;
    assert_int_equal(vdna_window_mem_size(&config), 0);
    config = by_frames(1);
    config.tap_count = 0;
    assert_int_equal(vdna_window_mem_size(&config), 0);
    config = by_frames(1);
    config.struct_size = 0;
    assert_int_equal(vdna_window_mem_size(&config), 0);
    assert_int_equal(vdna_window_mem_size(NULL), 0);
    vdna_window window;
    assert_int_equal(vdna_window_init(NULL, block, sizeof block, &window), VDNA_ERR_ARG);
}

static void a_range_without_width_is_refused(void **state)
{
    (void)state;
    const float flat[] = {3, 3};
    vdna_window_config config = by_frames(1);
    config.range = flat;
    vdna_window window;
    assert_int_equal(vdna_window_init(&config, block, sizeof block, &window), VDNA_ERR_ARG);
}

static void a_capacity_that_cannot_be_counted_or_addressed_is_refused(void **state)
{
    (void)state;
    const vdna_activations many[] = {{NULL, 1, 65536, 0}};
    vdna_window_config config = by_frames(65535);
    config.taps = many;
    /* As many as can be counted; 8 GB, which not every size_t can say. */
    if (SIZE_MAX > UINT32_MAX)
        assert_true(vdna_window_mem_size(&config) > (uint64_t)65536 * 65535 * 2);
    config.capacity = 65536;
    assert_int_equal(vdna_window_mem_size(&config), 0);

    const vdna_activations beyond_memory[] = {{NULL, 1u << 30, 1u << 31, 0}};
    config = by_frames(1);
    config.taps = beyond_memory;
    assert_int_equal(vdna_window_mem_size(&config), 0);
}

static void defaults_are_by_frames_with_a_thousand_bins(void **state)
{
    (void)state;
    vdna_window_config config;
    vdna_window_config_init(&config);
    assert_int_equal(config.struct_size, sizeof config);
    assert_int_equal(config.bins, 1000);
    assert_int_equal(config.length_us, 0);
    assert_int_equal(config.capacity, 0);
    vdna_window_config_init(NULL);
}

/* Long runs. Frames are a function of their number, so that those of the window can be made
 * again and counted from nothing. */
typedef struct long_run {
    vdna_activations taps[2];
    size_t tap_count;
    vdna_window window;
    float *values[2];
    float *range;
    vdna_hist again;
} long_run;

static uint32_t mixed(uint64_t x)
{
    x = (x ^ x >> 31) * 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 29) * 0xbf58476d1ce4e5b9u;
    return (uint32_t)(x >> 32);
}

/* Values of frame number `frame`: about one in six lies beyond the range -1..1. */
static const vdna_activations *frame_of(long_run *run, uint64_t frame)
{
    for (size_t t = 0; t < run->tap_count; t++) {
        const size_t count = (size_t)run->taps[t].neurons * run->taps[t].samples;
        for (size_t i = 0; i < count; i++)
            run->values[t][i] =
                1.2f * ((float)mixed(frame << 24 ^ t << 20 ^ i) / 2147483648.0f - 1);
    }
    return run->taps;
}

/* Irregular, sometimes standing still: 0..39 ms apart. */
static int64_t utime_of(uint64_t frame)
{
    return (int64_t)(frame * 20000 + mixed(frame) % 20000);
}

static void begin(long_run *run, uint32_t capacity, int64_t length_us, uint32_t bins)
{
    vdna_hist_config hist;
    vdna_hist_config_init(&hist);
    for (size_t t = 0; t < run->tap_count; t++) {
        vdna_activations *tap = &run->taps[t];
        tap->values = run->values[t] = calloc((size_t)tap->neurons * tap->samples, sizeof(float));
        hist.neurons += tap->neurons;
    }
    run->range = calloc(2 * (size_t)hist.neurons, sizeof(float));
    for (size_t n = 0; n < hist.neurons; n++) {
        run->range[2 * n] = -1;
        run->range[2 * n + 1] = 1;
    }
    hist.range = run->range;
    hist.bins = bins;
    size_t size = vdna_hist_mem_size(&hist);
    assert_int_equal(vdna_hist_init(&hist, malloc(size), size, &run->again), VDNA_OK);

    vdna_window_config config;
    vdna_window_config_init(&config);
    config.capacity = capacity;
    config.length_us = length_us;
    config.taps = run->taps;
    config.tap_count = run->tap_count;
    config.range = run->range;
    config.bins = bins;
    size = vdna_window_mem_size(&config);
    assert_int_equal(vdna_window_init(&config, malloc(size), size, &run->window), VDNA_OK);
}

static void end(long_run *run)
{
    free(run->again.counts);
    free(run->window.utime);
    free(run->range);
    for (size_t t = 0; t < run->tap_count; t++)
        free(run->values[t]);
}

/* The window after frame number `last` is frames first..last: count those again and compare. */
static void assert_equal_to_recomputation(long_run *run, uint64_t last)
{
    const vdna_window_config *config = &run->window.config;
    uint64_t first = last;
    while (first > 0 && last - first + 1 < config->capacity &&
           (config->length_us == 0 || utime_of(last) - utime_of(first - 1) < config->length_us))
        first--;
    vdna_hist_reset(&run->again);
    for (uint64_t f = first; f <= last; f++)
        assert_int_equal(vdna_hist_add(&run->again, frame_of(run, f), run->tap_count), VDNA_OK);

    const vdna_hist *hist = &run->window.hist;
    const size_t words = (size_t)hist->neurons * (hist->bins + 2);
    assert_int_equal(hist->frames, last - first + 1);
    assert_memory_equal(hist->counts, run->again.counts, words * sizeof(uint32_t));
    assert_int_equal(run->window.first_utime, utime_of(first));
}

static void run_for(long_run *run, uint64_t frames, uint64_t check_every)
{
    for (uint64_t f = 0; f < frames; f++) {
        assert_int_equal(
            vdna_window_add(&run->window, utime_of(f), frame_of(run, f), run->tap_count), VDNA_OK);
        if (f % check_every == 0 || f + 1 == frames)
            assert_equal_to_recomputation(run, f);
    }
    end(run);
}

static void after_a_million_frames_it_equals_recomputation_by_frames(void **state)
{
    (void)state;
    long_run run = {.taps = {{NULL, 4, 1, VDNA_LAYOUT_SAMPLES_NEURONS}}, .tap_count = 1};
    begin(&run, 100, 0, 1000);
    run_for(&run, 1000000, 997);
}

static void after_a_million_frames_it_equals_recomputation_by_time(void **state)
{
    (void)state;
    long_run run = {.taps = {{NULL, 4, 1, VDNA_LAYOUT_SAMPLES_NEURONS}}, .tap_count = 1};
    begin(&run, 100, 1000000, VDNA_WINDOW_BINS_MAX);
    run_for(&run, 1000000, 9973);
}

static void tokens_of_a_transformer_leave_exactly(void **state)
{
    (void)state;
    long_run run = {.taps = {{NULL, 96, 197, VDNA_LAYOUT_SAMPLES_NEURONS}}, .tap_count = 1};
    begin(&run, 7, 0, 1000);
    run_for(&run, 200, 19);
}

static void a_feature_map_and_a_descriptor_leave_exactly(void **state)
{
    (void)state;
    long_run run = {.taps = {{NULL, 24, 3136, VDNA_LAYOUT_NEURONS_SAMPLES},
                             {NULL, 40, 1, VDNA_LAYOUT_SAMPLES_NEURONS}},
                    .tap_count = 2};
    begin(&run, 9, 150000, 500);
    run_for(&run, 100, 11);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(by_frames_the_oldest_leaves_when_the_window_is_full),
        cmocka_unit_test(what_lay_beyond_the_range_leaves_as_such),
        cmocka_unit_test(by_time_a_frame_leaves_when_it_is_as_old_as_the_window_is_long),
        cmocka_unit_test(more_frames_than_capacity_within_the_time_leave_early_and_that_shows),
        cmocka_unit_test(a_stamp_that_runs_backwards_empties_the_window_first),
        cmocka_unit_test(the_furthest_stamps_are_far_apart),
        cmocka_unit_test(a_refused_frame_changes_nothing),
        cmocka_unit_test(taps_of_the_same_total_but_another_division_are_refused),
        cmocka_unit_test(a_reset_window_is_empty_and_keeps_its_counters),
        cmocka_unit_test(the_block_may_not_be_a_byte_too_small_nor_misaligned),
        cmocka_unit_test(bad_configs_have_no_size),
        cmocka_unit_test(a_range_without_width_is_refused),
        cmocka_unit_test(a_capacity_that_cannot_be_counted_or_addressed_is_refused),
        cmocka_unit_test(defaults_are_by_frames_with_a_thousand_bins),
        cmocka_unit_test(after_a_million_frames_it_equals_recomputation_by_frames),
        cmocka_unit_test(after_a_million_frames_it_equals_recomputation_by_time),
        cmocka_unit_test(tokens_of_a_transformer_leave_exactly),
        cmocka_unit_test(a_feature_map_and_a_descriptor_leave_exactly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
