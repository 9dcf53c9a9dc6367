#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <vdna/window.h>

#include "cmocka_all.h"

/* One neuron with four bins over 0..4, one sample a frame. */
#define BINS 4
static const float range[] = {0, 4};
static const vdna_activations one_sample[] = {{NULL, 1, 1, VDNA_LAYOUT_SAMPLES_NEURONS}};
static int64_t block[128];

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

static vdna_window_config first_frames(uint32_t frames)
{
    vdna_window_config config = by_frames(frames);
    config.which = VDNA_WINDOW_FIRST;
    return config;
}

static vdna_window_config first_time(int64_t length_us, uint32_t capacity)
{
    vdna_window_config config = by_time(length_us, capacity);
    config.which = VDNA_WINDOW_FIRST;
    return config;
}

static vdna_window *window_of(vdna_window_config config)
{
    vdna_window *window;
    assert_int_equal(vdna_window_init(&config, block, sizeof block, &window), VDNA_OK);
    return window;
}

static vdna_status try_add(vdna_window *window, int64_t utime, float value)
{
    const vdna_activations tap = {&value, 1, 1, VDNA_LAYOUT_SAMPLES_NEURONS};
    return vdna_window_add(window, utime, &tap, 1, NULL);
}

static void add(vdna_window *window, int64_t utime, float value)
{
    assert_int_equal(try_add(window, utime, value), VDNA_OK);
}

/* The events of a frame: VDNA_WINDOW_ bits. */
static uint32_t events_of(vdna_window *window, int64_t utime, float value)
{
    const vdna_activations tap = {&value, 1, 1, VDNA_LAYOUT_SAMPLES_NEURONS};
    uint32_t events = 77;
    assert_int_equal(vdna_window_add(window, utime, &tap, 1, &events), VDNA_OK);
    return events;
}

/* The mass of a window, to be set to values that no test has time to count to. */
static uint32_t *mass_of(vdna_window *window)
{
    return vdna_window_hist(window)->mass;
}

static void assert_counts(const vdna_window *window, uint32_t c0, uint32_t c1, uint32_t c2,
                          uint32_t c3, uint32_t saturated)
{
    const uint32_t counts[BINS] = {c0, c1, c2, c3};
    const vdna_hist *hist = vdna_window_hist(window);
    assert_memory_equal(hist->counts, counts, sizeof counts);
    assert_int_equal(hist->mass[0], c0 + c1 + c2 + c3);
    assert_int_equal(hist->frames, c0 + c1 + c2 + c3);
    assert_int_equal(hist->saturated[0], saturated);
}

static void by_frames_the_oldest_leaves_when_the_window_is_full(void **state)
{
    (void)state;
    vdna_window *window = window_of(by_frames(2));
    assert_counts(window, 0, 0, 0, 0, 0);
    add(window, 10, 0.5f);
    assert_counts(window, 1, 0, 0, 0, 0);
    add(window, 20, 1.5f);
    assert_counts(window, 1, 1, 0, 0, 0);
    add(window, 30, 2.5f);
    assert_counts(window, 0, 1, 1, 0, 0);
    assert_int_equal(vdna_window_first_utime(window), 20);
    assert_int_equal(vdna_window_last_utime(window), 30);
    assert_int_equal(vdna_window_truncated(window), 0);
    assert_int_equal(vdna_window_left_early(window), 0);
}

static void a_saturated_sample_leaves_as_a_saturated_one(void **state)
{
    (void)state;
    vdna_window *window = window_of(by_frames(2));
    add(window, 0, -1);
    add(window, 1, 5);
    assert_counts(window, 1, 0, 0, 1, 2);
    add(window, 2, 0);
    assert_counts(window, 1, 0, 0, 1, 1);
    add(window, 3, 4);
    assert_counts(window, 1, 0, 0, 1, 0);
}

static void by_time_a_frame_leaves_when_it_is_as_old_as_the_window_is_long(void **state)
{
    (void)state;
    vdna_window *window = window_of(by_time(1000, 8));
    add(window, 5000, 0.5f);
    add(window, 5999, 1.5f);
    assert_counts(window, 1, 1, 0, 0, 0);
    add(window, 6000, 2.5f);
    assert_counts(window, 0, 1, 1, 0, 0);
    assert_int_equal(vdna_window_first_utime(window), 5999);
    add(window, 90000, 3.5f);
    assert_counts(window, 0, 0, 0, 1, 0);
    assert_int_equal(vdna_window_first_utime(window), 90000);
    assert_int_equal(vdna_window_left_early(window), 0);
}

static void more_frames_than_capacity_within_the_time_leave_early_and_that_shows(void **state)
{
    (void)state;
    vdna_window *window = window_of(by_time(1000, 2));
    add(window, 0, 0.5f);
    add(window, 400, 1.5f);
    assert_int_equal(vdna_window_truncated(window), 0);
    add(window, 800, 2.5f);
    assert_counts(window, 0, 1, 1, 0, 0);
    assert_int_equal(vdna_window_truncated(window), 1);
    assert_int_equal(vdna_window_left_early(window), 1);
    assert_int_equal(vdna_window_left_utime(window), 0);

    /* The frame at 0 would still belong to a window that ends at 999, but not at 1400, when the one
     * at 400 leaves as well. */
    add(window, 1400, 3.5f);
    assert_counts(window, 0, 0, 1, 1, 0);
    assert_int_equal(vdna_window_truncated(window), 0);
    assert_int_equal(vdna_window_left_early(window), 1);
}

static void a_stamp_that_runs_backwards_empties_the_window_first(void **state)
{
    (void)state;
    for (int time = 0; time < 2; time++) {
        vdna_window *window = window_of(time ? by_time(1000, 3) : by_frames(3));
        add(window, 500, 0.5f);
        add(window, 500, 1.5f);
        assert_int_equal(vdna_window_restarts(window), 0);
        add(window, 499, 2.5f);
        assert_counts(window, 0, 0, 1, 0, 0);
        assert_int_equal(vdna_window_restarts(window), 1);
        assert_int_equal(vdna_window_first_utime(window), 499);
        assert_int_equal(vdna_window_truncated(window), 0);
    }
}

static void the_furthest_stamps_are_far_apart(void **state)
{
    (void)state;
    vdna_window *window = window_of(by_time(1000, 3));
    add(window, INT64_MIN, 0.5f);
    add(window, INT64_MAX, 1.5f);
    assert_counts(window, 0, 1, 0, 0, 0);
    add(window, INT64_MIN, 2.5f);
    assert_counts(window, 0, 0, 1, 0, 0);
    assert_int_equal(vdna_window_restarts(window), 1);
}

static void a_refused_frame_changes_nothing(void **state)
{
    (void)state;
    vdna_window *window = window_of(by_time(1000, 2));
    add(window, 0, 0.5f);
    add(window, 10, 1.5f);
    int64_t before[128];
    memcpy(before, block, sizeof before);

    const float values[] = {1, 2};
    const vdna_activations two_samples = {values, 1, 2, 0}, two_neurons = {values, 2, 1, 0};
    const vdna_activations other_layout = {values, 1, 1, VDNA_LAYOUT_NEURONS_SAMPLES};
    const vdna_activations none = {NULL, 1, 1, 0};
    assert_int_equal(try_add(window, 2000, NAN), VDNA_ERR_NONFINITE);
    assert_int_equal(vdna_window_add(window, 2000, &two_samples, 1, NULL), VDNA_ERR_MISMATCH);
    assert_int_equal(vdna_window_add(window, 2000, &two_neurons, 1, NULL), VDNA_ERR_MISMATCH);
    assert_int_equal(vdna_window_add(window, 2000, &other_layout, 1, NULL), VDNA_ERR_MISMATCH);
    assert_int_equal(vdna_window_add(window, 2000, &none, 1, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_window_add(window, 2000, NULL, 1, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_window_add(NULL, 2000, &two_samples, 1, NULL), VDNA_ERR_ARG);
    assert_memory_equal(block, before, sizeof before);
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
    vdna_window *window = window_of(config);
    assert_int_equal(vdna_window_add(window, 0, &one, 1, NULL), VDNA_ERR_MISMATCH);
    assert_int_equal(vdna_window_add(window, 0, swapped, 2, NULL), VDNA_ERR_MISMATCH);
    assert_int_equal(vdna_window_add(window, 0, two, 2, NULL), VDNA_OK);
}

static void a_reset_window_is_empty_and_keeps_its_counters(void **state)
{
    (void)state;
    vdna_window *window = window_of(by_time(1000, 1));
    add(window, 0, 0.5f);
    add(window, 1, 0.5f);
    assert_int_equal(vdna_window_truncated(window), 1);
    vdna_window_reset(window);
    assert_counts(window, 0, 0, 0, 0, 0);
    assert_int_equal(vdna_window_truncated(window), 0);
    assert_int_equal(vdna_window_left_early(window), 1);
    /* Also with an earlier stamp: the old frames are forgotten. */
    add(window, -7, 3.5f);
    assert_counts(window, 0, 0, 0, 1, 0);
    assert_int_equal(vdna_window_restarts(window), 0);
    vdna_window_reset(NULL);
}

static void the_block_may_not_be_a_byte_too_small_nor_misaligned(void **state)
{
    (void)state;
    const vdna_window_config config = by_frames(3);
    const size_t size = vdna_window_mem_size(&config);
    vdna_window *window;
    vdna_window_config first = config;
    first.which = VDNA_WINDOW_FIRST;
    const size_t without_frames = vdna_window_mem_size(&first);
    assert_in_range(without_frames, (BINS + 2) * 4, (BINS + 2) * 4 + 160);
    assert_int_equal(size, without_frames + 3 * 8 + 3 * 2);
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
    config.struct_size = sizeof config + 1;
    assert_int_equal(vdna_window_mem_size(&config), 0);
    config = by_frames(1);
    config.which = VDNA_WINDOW_FIRST + 1;
    assert_int_equal(vdna_window_mem_size(&config), 0);
    config = first_frames(1);
    config.bins = VDNA_HIST_BINS_MAX + 1;
    assert_int_equal(vdna_window_mem_size(&config), 0);
    assert_int_equal(vdna_window_mem_size(NULL), 0);
    vdna_window *window;
    assert_int_equal(vdna_window_init(NULL, block, sizeof block, &window), VDNA_ERR_ARG);
}

static void a_range_without_width_is_refused(void **state)
{
    (void)state;
    const float flat[] = {3, 3};
    vdna_window_config config = by_frames(1);
    config.range = flat;
    vdna_window *window;
    assert_int_equal(vdna_window_init(&config, block, sizeof block, &window), VDNA_ERR_ARG);
}

static void a_capacity_that_cannot_be_counted_or_addressed_is_refused(void **state)
{
    (void)state;
    const vdna_activations many[] = {{NULL, 1, 65536, 0}};
    vdna_window_config config = by_frames(65535);
    config.taps = many;
    /* The most that can be counted: 8 GB, beyond some size_t. */
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
    assert_int_equal(config.which, VDNA_WINDOW_LAST);
    vdna_window_config_init(NULL);
}

/* Version 0.1 had no `which`; test/contract/abi/old_caller.c is a program compiled with it. */
#define SIZE_0_1 offsetof(vdna_window_config, which)

static void an_older_config_gets_the_defaults_of_the_fields_it_lacks(void **state)
{
    (void)state;
    vdna_window_config config = by_frames(2);
    config.struct_size = SIZE_0_1;
    config.which = 77; /* the old caller's memory, not part of its struct */
    vdna_window *window = window_of(config);
    for (int64_t utime = 0; utime < 5; utime++)
        assert_int_equal(events_of(window, utime, 0.5f), VDNA_WINDOW_ADDED);
    config.struct_size = SIZE_0_1 - 1;
    assert_int_equal(vdna_window_mem_size(&config), 0);
}

static void defaults_are_written_as_far_as_the_caller_has_room(void **state)
{
    (void)state;
    struct {
        vdna_window_config config;
        unsigned char beyond[16];
    } room;
    const size_t sizes[] = {4, SIZE_0_1, sizeof room.config, sizeof room};
    for (size_t i = 0; i < 4; i++) {
        memset(&room, 0xAA, sizeof room);
        vdna_window_config_init_sized(&room.config, sizes[i]);
        assert_int_equal(room.config.struct_size, sizes[i]);
        assert_int_equal(room.config.bins, i == 0 ? 0xAAAAAAAA : 1000);
        for (size_t b = 0; b < sizeof room; b++) {
            const int is_written = ((unsigned char *)&room)[b] != 0xAA;
            assert_int_equal(is_written, b < sizes[i]);
        }
    }
    /* Newer than this library: refused by every function that takes it. */
    room.config = by_frames(1);
    assert_int_not_equal(vdna_window_mem_size(&room.config), 0);
    room.config.struct_size = sizeof room;
    assert_int_equal(vdna_window_mem_size(&room.config), 0);

    const unsigned char untouched[3] = {1, 2, 3};
    unsigned char tiny[3] = {1, 2, 3};
    vdna_window_config_init_sized((vdna_window_config *)(void *)tiny, sizeof tiny);
    assert_memory_equal(tiny, untouched, sizeof tiny);
    vdna_window_config_init_sized(NULL, sizeof room.config);
}

static void the_function_behind_the_macro_writes_what_version_0_1_had(void **state)
{
    (void)state;
    vdna_window_config config;
    memset(&config, 0xAA, sizeof config);
    (vdna_window_config_init)(&config);
    assert_int_equal(config.struct_size, SIZE_0_1);
    assert_int_equal(config.bins, 1000);
    assert_true(config.which == 0xAAAAAAAAAAAAAAAA);
    (vdna_window_config_init)(NULL);
}

static void a_last_window_is_never_complete_and_tells_of_restarts(void **state)
{
    (void)state;
    vdna_window *window = window_of(by_frames(2));
    for (int64_t utime = 10; utime < 20; utime++)
        assert_int_equal(events_of(window, utime, 1), VDNA_WINDOW_ADDED);
    assert_int_equal(events_of(window, 18, 1), VDNA_WINDOW_ADDED | VDNA_WINDOW_RESTARTED);
    assert_int_equal(vdna_window_hist(window)->frames, 1);
}

static void the_stamp_of_the_frame_that_left_early_is_told_while_it_is_missed(void **state)
{
    (void)state;
    vdna_window *window = window_of(by_time(1000, 2));
    for (int64_t utime = 300; utime <= 500; utime += 100)
        add(window, utime, 0.5f);
    assert_int_equal(vdna_window_left_utime(window), 300);
    add(window, 2000, 0.5f);
    assert_int_equal(vdna_window_left_utime(window), 0);
}

static void the_masses_of_a_last_window_are_bounded_by_its_capacity_alone(void **state)
{
    (void)state;
    vdna_window *window = window_of(by_frames(2));
    add(window, 0, 0.5f);
    add(window, 1, 0.5f);
    *mass_of(window) = UINT32_MAX; /* as after 2 frames of 2^31 samples, less one */
    add(window, 2, 0.5f);
    assert_int_equal(*mass_of(window), UINT32_MAX);
}

static void the_nth_frame_completes_the_first_n(void **state)
{
    (void)state;
    vdna_window *window = window_of(first_frames(3));
    assert_int_equal(events_of(window, 10, 0.5f), VDNA_WINDOW_ADDED);
    assert_int_equal(events_of(window, 10, 1.5f), VDNA_WINDOW_ADDED); /* at the same time */
    assert_int_equal(events_of(window, INT64_MAX, 2.5f), VDNA_WINDOW_ADDED | VDNA_WINDOW_COMPLETE);
    assert_counts(window, 1, 1, 1, 0, 0);
    assert_int_equal(vdna_window_first_utime(window), 10);
    assert_int_equal(vdna_window_last_utime(window), INT64_MAX);
}

static void the_first_frame_beyond_completes_the_first_t_and_is_not_in_it(void **state)
{
    (void)state;
    vdna_window *window = window_of(first_time(1000, UINT32_MAX));
    assert_int_equal(events_of(window, 5000, 0.5f), VDNA_WINDOW_ADDED);
    assert_int_equal(events_of(window, 5999, 9.5f), VDNA_WINDOW_ADDED);
    assert_int_equal(events_of(window, 6000, 2.5f), VDNA_WINDOW_COMPLETE);
    assert_counts(window, 1, 0, 0, 1, 1);
    assert_int_equal(vdna_window_first_utime(window), 5000);
    assert_int_equal(vdna_window_last_utime(window), 5999);
    /* As an unsigned difference, these stamps are further apart than any T. */
    window = window_of(first_time(INT64_MAX, UINT32_MAX));
    assert_int_equal(events_of(window, INT64_MIN, 0.5f), VDNA_WINDOW_ADDED);
    assert_int_equal(events_of(window, INT64_MAX, 0.5f), VDNA_WINDOW_COMPLETE);
}

static void the_first_t_is_complete_with_the_last_frame_that_has_room(void **state)
{
    (void)state;
    vdna_window *window = window_of(first_time(1000, 2));
    assert_int_equal(events_of(window, 0, 0.5f), VDNA_WINDOW_ADDED);
    assert_int_equal(events_of(window, 1, 0.5f), VDNA_WINDOW_ADDED | VDNA_WINDOW_COMPLETE);
    assert_int_equal(vdna_window_truncated(window), 0);
    assert_int_equal(vdna_window_left_early(window), 0);
}

static void a_complete_window_takes_no_more_frames_until_it_is_reset(void **state)
{
    (void)state;
    const vdna_window_config configs[] = {first_frames(1), first_time(10, UINT32_MAX)};
    for (size_t i = 0; i < 2; i++) {
        vdna_window *window = window_of(configs[i]);
        add(window, 100, 0.5f);
        add(window, 110, 0.5f);
        for (int64_t utime = 120; utime > 80; utime -= 20) /* also with earlier stamps */
            assert_int_equal(events_of(window, utime, 3.5f), VDNA_WINDOW_COMPLETE);
        assert_counts(window, 1, 0, 0, 0, 0);
        assert_int_equal(vdna_window_restarts(window), 0);
        assert_int_equal(try_add(window, 130, NAN), VDNA_ERR_NONFINITE);
        vdna_window_reset(window);
        assert_int_equal(vdna_window_first_utime(window), 0);
        assert_int_equal(vdna_window_last_utime(window), 0);
        assert_true(events_of(window, -7, 3.5f) & VDNA_WINDOW_ADDED);
        assert_counts(window, 0, 0, 0, 1, 0);
    }
}

static void a_backward_stamp_begins_a_first_window_anew(void **state)
{
    (void)state;
    const vdna_window_config configs[] = {first_frames(3), first_time(1000, UINT32_MAX)};
    for (size_t i = 0; i < 2; i++) {
        vdna_window *window = window_of(configs[i]);
        add(window, 400, 0.5f);
        add(window, 600, 0.5f);
        /* Behind the newest frame, though not behind the first. */
        assert_int_equal(events_of(window, 599, 3.5f), VDNA_WINDOW_ADDED | VDNA_WINDOW_RESTARTED);
        assert_counts(window, 0, 0, 0, 1, 0);
        assert_int_equal(vdna_window_first_utime(window), 599);
        assert_int_equal(vdna_window_restarts(window), 1);
    }
}

static void a_first_window_keeps_no_frames(void **state)
{
    (void)state;
    const vdna_activations tokens[] = {{NULL, 1, 197, 0}};
    vdna_window_config config = first_frames(1);
    const size_t size = vdna_window_mem_size(&config);
    config.capacity = UINT32_MAX;
    assert_int_equal(vdna_window_mem_size(&config), size);
    config.taps = tokens;
    assert_int_equal(vdna_window_mem_size(&config), size);
    config = first_frames(1);
    config.bins = VDNA_HIST_BINS_MAX;
    assert_true(vdna_window_mem_size(&config) > size);
}

static void a_first_window_takes_any_division_into_taps(void **state)
{
    (void)state;
    const float ranges[] = {0, 4, 0, 4}, values[] = {0, 1, 2, 3};
    const vdna_activations shape = {NULL, 2, 1, 0};
    const vdna_activations two[] = {{values, 1, 3, 0}, {values, 1, 1, 1}}, one = {values, 2, 2, 1};
    vdna_window_config config = first_frames(9);
    config.taps = &shape;
    config.range = ranges;
    vdna_window *window = window_of(config);
    assert_int_equal(vdna_window_add(window, 0, two, 2, NULL), VDNA_OK);
    assert_int_equal(vdna_window_add(window, 0, &one, 1, NULL), VDNA_OK);
    assert_int_equal(vdna_window_add(window, 0, two, 1, NULL), VDNA_ERR_MISMATCH);
    assert_int_equal(mass_of(window)[0], 5);
    assert_int_equal(mass_of(window)[1], 3);
}

static void a_first_window_whose_counts_are_full_is_unchanged(void **state)
{
    (void)state;
    vdna_window *window = window_of(first_time(1000, UINT32_MAX));
    add(window, 0, 0.5f);
    *mass_of(window) = UINT32_MAX;
    assert_int_equal(try_add(window, 1, 0.5f), VDNA_ERR_FULL);
    assert_int_equal(vdna_window_hist(window)->frames, 1);
    assert_int_equal(*mass_of(window), UINT32_MAX);
    /* A frame beyond the window, or one that begins it anew, needs no such room. */
    assert_int_equal(events_of(window, 1000, 0.5f), VDNA_WINDOW_COMPLETE);
    vdna_window_reset(window);
    add(window, 0, 0.5f);
    *mass_of(window) = UINT32_MAX;
    assert_int_equal(events_of(window, -1, 0.5f), VDNA_WINDOW_ADDED | VDNA_WINDOW_RESTARTED);
    assert_int_equal(*mass_of(window), 1);
}

static void a_first_window_by_time_takes_frames_in_until_it_has_enough(void **state)
{
    (void)state;
    vdna_window_config config = first_time(1000, 8);
    config.least_frames = 3;
    vdna_window *window = window_of(config);
    assert_int_equal(events_of(window, 0, 0.5f), VDNA_WINDOW_ADDED);
    assert_int_equal(events_of(window, 500, 0.5f), VDNA_WINDOW_ADDED);
    assert_true(vdna_window_progress(window) == 0.5);
    assert_int_equal(events_of(window, 2000, 0.5f), VDNA_WINDOW_ADDED);
    assert_true(vdna_window_progress(window) == 1);
    assert_int_equal(events_of(window, 2001, 0.5f), VDNA_WINDOW_COMPLETE);
    assert_int_equal(vdna_window_hist(window)->frames, 3);

    config.least_frames = 9; /* more than its capacity */
    assert_int_equal(vdna_window_mem_size(&config), 0);
}

static void progress_is_the_share_of_frames_or_of_time(void **state)
{
    (void)state;
    const vdna_window_config configs[] = {by_frames(4), first_frames(4)};
    for (size_t i = 0; i < 2; i++) {
        vdna_window *window = window_of(configs[i]);
        assert_true(vdna_window_progress(window) == 0);
        add(window, 0, 1);
        assert_true(vdna_window_progress(window) == 0.25);
        for (int64_t utime = 1; utime < 4; utime++)
            add(window, utime, 1);
        assert_true(vdna_window_progress(window) == 1);
    }
    const vdna_window_config timed[] = {by_time(1000, 4), first_time(1000, 4)};
    for (size_t i = 0; i < 2; i++) {
        vdna_window *window = window_of(timed[i]);
        add(window, 100, 1);
        add(window, 600, 1);
        assert_true(vdna_window_progress(window) == 0.5);
        add(window, 1100, 1);
        assert_true(vdna_window_progress(window) == (i == 0 ? 0.5 : 1));
    }
}

static void a_window_that_is_not_there_has_nothing(void **state)
{
    (void)state;
    assert_null(vdna_window_hist(NULL));
    assert_int_equal(vdna_window_first_utime(NULL), 0);
    assert_int_equal(vdna_window_last_utime(NULL), 0);
    assert_true(vdna_window_progress(NULL) == 0);
    assert_int_equal(vdna_window_truncated(NULL), 0);
    assert_int_equal(vdna_window_left_utime(NULL), 0);
    assert_int_equal(vdna_window_left_early(NULL), 0);
    assert_int_equal(vdna_window_restarts(NULL), 0);
}

/* Long runs. A frame is a function of its number, so that those in the window can be made again and
 * counted from scratch. */
typedef struct long_run {
    vdna_activations taps[2];
    size_t tap_count;
    vdna_window_config config;
    vdna_window *window; /* at the beginning of its block */
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

    vdna_window_config *config = &run->config;
    vdna_window_config_init(config);
    config->capacity = capacity;
    config->length_us = length_us;
    config->taps = run->taps;
    config->tap_count = run->tap_count;
    config->range = run->range;
    config->bins = bins;
    size = vdna_window_mem_size(config);
    assert_int_equal(vdna_window_init(config, malloc(size), size, &run->window), VDNA_OK);
}

static void end(long_run *run)
{
    free(run->again.counts);
    free(run->window);
    free(run->range);
    for (size_t t = 0; t < run->tap_count; t++)
        free(run->values[t]);
}

/* The window after frame number `last` is frames first..last: count those again and compare. */
static void assert_equal_to_recomputation(long_run *run, uint64_t last)
{
    const vdna_window_config *config = &run->config;
    uint64_t first = last;
    while (first > 0 && last - first + 1 < config->capacity &&
           (config->length_us == 0 || utime_of(last) - utime_of(first - 1) < config->length_us))
        first--;
    vdna_hist_reset(&run->again);
    for (uint64_t f = first; f <= last; f++)
        assert_int_equal(vdna_hist_add(&run->again, frame_of(run, f), run->tap_count), VDNA_OK);

    const vdna_hist *hist = vdna_window_hist(run->window);
    const size_t words = (size_t)hist->neurons * (hist->bins + 2);
    assert_int_equal(hist->frames, last - first + 1);
    assert_memory_equal(hist->counts, run->again.counts, words * sizeof(uint32_t));
    assert_int_equal(vdna_window_first_utime(run->window), utime_of(first));
}

static void run_for(long_run *run, uint64_t frames, uint64_t check_every)
{
    for (uint64_t f = 0; f < frames; f++) {
        assert_int_equal(
            vdna_window_add(run->window, utime_of(f), frame_of(run, f), run->tap_count, NULL),
            VDNA_OK);
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
        cmocka_unit_test(a_saturated_sample_leaves_as_a_saturated_one),
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
        cmocka_unit_test(an_older_config_gets_the_defaults_of_the_fields_it_lacks),
        cmocka_unit_test(defaults_are_written_as_far_as_the_caller_has_room),
        cmocka_unit_test(the_function_behind_the_macro_writes_what_version_0_1_had),
        cmocka_unit_test(a_last_window_is_never_complete_and_tells_of_restarts),
        cmocka_unit_test(the_stamp_of_the_frame_that_left_early_is_told_while_it_is_missed),
        cmocka_unit_test(the_masses_of_a_last_window_are_bounded_by_its_capacity_alone),
        cmocka_unit_test(the_nth_frame_completes_the_first_n),
        cmocka_unit_test(the_first_frame_beyond_completes_the_first_t_and_is_not_in_it),
        cmocka_unit_test(the_first_t_is_complete_with_the_last_frame_that_has_room),
        cmocka_unit_test(a_complete_window_takes_no_more_frames_until_it_is_reset),
        cmocka_unit_test(a_backward_stamp_begins_a_first_window_anew),
        cmocka_unit_test(a_first_window_keeps_no_frames),
        cmocka_unit_test(a_first_window_takes_any_division_into_taps),
        cmocka_unit_test(a_first_window_whose_counts_are_full_is_unchanged),
        cmocka_unit_test(a_first_window_by_time_takes_frames_in_until_it_has_enough),
        cmocka_unit_test(progress_is_the_share_of_frames_or_of_time),
        cmocka_unit_test(a_window_that_is_not_there_has_nothing),
        cmocka_unit_test(after_a_million_frames_it_equals_recomputation_by_frames),
        cmocka_unit_test(after_a_million_frames_it_equals_recomputation_by_time),
        cmocka_unit_test(tokens_of_a_transformer_leave_exactly),
        cmocka_unit_test(a_feature_map_and_a_descriptor_leave_exactly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
