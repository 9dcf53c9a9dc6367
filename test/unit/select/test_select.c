#include <math.h>
#include <string.h>

#include <vdna/select.h>

#include "cmocka_all.h"

/* One neuron, four bins over 0..4, embeddings of one number. Experience "low" has all its samples
 * in bin 0 and embeddings 0 10 20; "high" has them in bin 3 and embeddings 5 6. */
#define BINS 4
static const float range[] = {0, 4};
static const uint32_t low_counts[BINS] = {3, 0, 0, 0}, low_mass = 3;
static const uint32_t high_counts[BINS] = {0, 0, 0, 2}, high_mass = 2;
static const float low_embeddings[] = {0, 10, 20}, high_embeddings[] = {5, 6};
static const vdna_select_candidate candidates[] = {
    {{range, low_counts, &low_mass, 1, BINS}, low_embeddings, 3, 0},
    {{range, high_counts, &high_mass, 1, BINS}, high_embeddings, 2, 0},
};

static int64_t block[256];

/* In microseconds, with no bound of late frames: every step back begins the warmup anew. */
static vdna_select_config by_frames(uint32_t frames)
{
    vdna_select_config config;
    vdna_select_config_init(&config);
    config.candidates = candidates;
    config.candidate_count = 2;
    config.dim = 1;
    config.warmup_frames = frames;
    config.late_us = 0;
    config.time_unit = VDNA_TIME_UNIT_US;
    return config;
}

static vdna_select_config by_time(int64_t microseconds)
{
    vdna_select_config config = by_frames(0);
    config.warmup_us = microseconds;
    config.warmup_frames_min = 1;
    return config;
}

static vdna_select *selector(vdna_select_config config)
{
    vdna_select *select;
    assert_int_equal(vdna_select_init(&config, block, sizeof block, &select), VDNA_OK);
    return select;
}

/* The mass of the live window, to be set to values that no test has time to count to. */
static uint32_t *live_mass(vdna_select *select)
{
    vdna_hist_view live;
    vdna_select_live(select, &live);
    return (uint32_t *)live.mass;
}

static vdna_status try_frame(vdna_select *select, int64_t utime, float activation, float embedding,
                             vdna_select_answer *answer)
{
    const vdna_activations tap = {&activation, 1, 1, 0};
    const vdna_select_frame frame = {utime, &tap, 1, &embedding};
    return vdna_select_feed(select, &frame, answer);
}

static vdna_select_answer feed(vdna_select *select, int64_t utime, float activation,
                               float embedding)
{
    vdna_select_answer answer;
    assert_int_equal(try_frame(select, utime, activation, embedding, &answer), VDNA_OK);
    return answer;
}

static void the_nth_frame_completes_a_warmup_by_frames(void **state)
{
    (void)state;
    vdna_select *select = selector(by_frames(2));
    vdna_select_answer answer = feed(select, 100, 3.5f, 5);
    assert_int_equal(answer.state, VDNA_SELECT_WARMUP);
    assert_int_equal(answer.newly_ranked, 0);
    assert_int_equal(answer.localised, 0);

    answer = feed(select, 200, 3.5f, 5);
    assert_int_equal(answer.state, VDNA_SELECT_SELECTED);
    assert_int_equal(answer.newly_ranked, 1);
    assert_int_equal(answer.localised, 0);
    assert_int_equal(vdna_select_chosen(select), 1);
    assert_int_equal(vdna_select_ranking(select, NULL)[0].candidate, 1);
    assert_true(vdna_select_ranking(select, NULL)[0].distance_bins == 0 &&
                vdna_select_ranking(select, NULL)[1].distance_bins == 3);
    assert_true(vdna_select_margin_bins(select) == 3);
    assert_int_equal(vdna_select_first_utime(select), 100);
    assert_int_equal(vdna_select_last_utime(select), 200);
    vdna_hist_view live;
    const uint32_t counts[] = {0, 0, 0, 2};
    vdna_select_live(select, &live);
    assert_memory_equal(live.counts, counts, sizeof counts);
}

static void there_is_no_ranking_before_the_choice(void **state)
{
    (void)state;
    vdna_select *select = selector(by_frames(1));
    uint32_t count = 77;
    assert_null(vdna_select_ranking(select, &count));
    assert_int_equal(count, 0);
    feed(select, 0, 0.5f, 0);
    assert_non_null(vdna_select_ranking(select, &count));
    assert_int_equal(count, 2);
    vdna_select_reset(select);
    assert_null(vdna_select_ranking(select, NULL));
    assert_int_equal(vdna_select_first_utime(select), 0);
    assert_int_equal(vdna_select_last_utime(select), 0);
}

static void a_selector_that_is_not_there_has_nothing(void **state)
{
    (void)state;
    uint32_t count = 77;
    vdna_hist_view live = candidates[0].dna;
    assert_int_equal(vdna_select_state(NULL), VDNA_SELECT_WARMUP);
    assert_int_equal(vdna_select_chosen(NULL), 0);
    assert_true(vdna_select_margin_bins(NULL) == 0);
    assert_null(vdna_select_ranking(NULL, &count));
    assert_int_equal(count, 0);
    vdna_select_live(NULL, &live);
    assert_ptr_equal(live.counts, low_counts);
    vdna_select_live(selector(by_frames(1)), NULL);
    assert_int_equal(vdna_select_window_frames(NULL), 0);
    assert_int_equal(vdna_select_first_utime(NULL), 0);
    assert_int_equal(vdna_select_last_utime(NULL), 0);
    assert_int_equal(vdna_select_accepted(NULL), 0);
    assert_int_equal(vdna_select_rejected(NULL), 0);
    assert_int_equal(vdna_select_restarts(NULL), 0);
    assert_int_equal(vdna_select_restart_cause(NULL), VDNA_RESTART_NONE);
    assert_null(vdna_select_time(NULL));
}

static void later_frames_are_localised_in_the_chosen_experience(void **state)
{
    (void)state;
    vdna_select *select = selector(by_frames(1));
    feed(select, 0, 0.5f, 0);
    const vdna_select_answer answer = feed(select, 1, 3.5f, 12);
    assert_int_equal(answer.newly_ranked, 0);
    assert_int_equal(answer.localised, 1);
    assert_int_equal(vdna_select_chosen(select), 0);
    assert_int_equal(answer.match.index, 1);
    assert_true(answer.match.distance_sq == 4);
    assert_null(vdna_select_where(select)); /* which localisers tell */
}

static void later_frames_do_not_change_the_choice_nor_the_live_histogram(void **state)
{
    (void)state;
    vdna_select *select = selector(by_frames(1));
    feed(select, 0, 0.5f, 0);
    for (int i = 1; i < 20; i++)
        assert_int_equal(feed(select, i, 3.5f, 5).newly_ranked, 0);
    assert_int_equal(vdna_select_chosen(select), 0);
    assert_int_equal(vdna_select_window_frames(select), 1);
}

static void a_warmup_by_time_is_the_frames_before_first_plus_t(void **state)
{
    (void)state;
    vdna_select *select = selector(by_time(1000));
    assert_int_equal(feed(select, 5000, 3.5f, 0).state, VDNA_SELECT_WARMUP);
    assert_int_equal(feed(select, 5999, 3.5f, 0).state, VDNA_SELECT_WARMUP);
    /* The frame that ends the window is not in it, but is the first one localised. */
    const vdna_select_answer answer = feed(select, 6000, 0.5f, 6);
    assert_int_equal(answer.state, VDNA_SELECT_SELECTED);
    assert_int_equal(answer.newly_ranked, 1);
    assert_int_equal(answer.localised, 1);
    assert_int_equal(answer.match.index, 1);
    assert_int_equal(vdna_select_window_frames(select), 2);
    assert_int_equal(vdna_select_chosen(select), 1);
}

static void camera_time_that_runs_backwards_begins_the_warmup_anew(void **state)
{
    (void)state;
    vdna_select *select = selector(by_frames(3));
    feed(select, 590, 0.5f, 0);
    feed(select, 600, 0.5f, 0);
    const vdna_select_answer answer = feed(select, 500, 3.5f, 0);
    assert_int_equal(answer.restarted, VDNA_RESTART_BACKWARDS);
    assert_int_equal(vdna_select_restart_cause(select), VDNA_RESTART_BACKWARDS);
    assert_int_equal(answer.state, VDNA_SELECT_WARMUP);
    assert_int_equal(vdna_select_restarts(select), 1);
    assert_int_equal(vdna_select_first_utime(select), 500);
    feed(select, 500, 3.5f, 0);
    assert_int_equal(feed(select, 501, 3.5f, 0).newly_ranked, 1);
    assert_int_equal(vdna_select_chosen(select), 1);
}

static void a_frame_that_cannot_be_localised_still_announces_the_choice(void **state)
{
    (void)state;
    vdna_select *select = selector(by_time(1000));
    feed(select, 0, 3.5f, 5);
    vdna_select_answer answer = feed(select, 1000, 3.5f, 1e30f);
    assert_int_equal(answer.state, VDNA_SELECT_SELECTED);
    assert_int_equal(answer.newly_ranked, 1);
    assert_int_equal(answer.localised, 0);
    assert_int_equal(vdna_select_accepted(select), 2);
    /* Later ones have nothing else to tell, so they are refused. */
    assert_int_equal(try_frame(select, 2000, 3.5f, 1e30f, &answer), VDNA_ERR_NONFINITE);
    assert_int_equal(vdna_select_rejected(select), 1);
}

static void a_backward_stamp_does_not_end_a_warmup_by_time(void **state)
{
    (void)state;
    vdna_select *select = selector(by_time(1000));
    feed(select, INT64_MAX, 3.5f, 0);
    vdna_select_answer answer = feed(select, INT64_MIN, 3.5f, 0);
    assert_int_equal(answer.restarted, 1);
    assert_int_equal(answer.state, VDNA_SELECT_WARMUP);
    /* As an unsigned difference the second of these stamps lies far beyond the window. */
    select = selector(by_time(1000));
    feed(select, 5000, 3.5f, 0);
    answer = feed(select, 4999, 3.5f, 0);
    assert_int_equal(answer.restarted, 1);
    assert_int_equal(answer.state, VDNA_SELECT_WARMUP);
}

static void a_late_frame_is_refused_and_counted_apart(void **state)
{
    (void)state;
    vdna_select_config config = by_frames(3);
    config.late_us = 100;
    vdna_select *select = selector(config);
    vdna_select_answer answer;
    feed(select, 590, 3.5f, 0);
    feed(select, 600, 3.5f, 0);
    assert_int_equal(try_frame(select, 500, 0.5f, 0, &answer), VDNA_ERR_LATE);
    assert_int_equal(vdna_select_window_frames(select), 2);
    assert_int_equal(vdna_select_time(select)->late, 1);
    assert_int_equal(vdna_select_rejected(select), 0);
    assert_int_equal(feed(select, 600, 3.5f, 0).newly_ranked, 1);
    /* Also after the choice, without changing it. */
    assert_int_equal(try_frame(select, 500, 0.5f, 0, &answer), VDNA_ERR_LATE);
    assert_int_equal(feed(select, 700, 3.5f, 5).localised, 1);
    assert_int_equal(vdna_select_accepted(select), 4);
}

static void frames_that_changed_places_do_not_keep_a_warmup_from_ending(void **state)
{
    (void)state;
    vdna_select_config config = by_frames(20);
    config.late_us = VDNA_TIME_LATE_US_DEFAULT;
    vdna_select *select = selector(config);
    vdna_select_answer answer;
    for (int64_t i = 0; i < 40; i++) {
        const int64_t place = i % 5 == 3 ? i + 1 : i % 5 == 4 ? i - 1 : i;
        try_frame(select, place * 33333, 3.5f, 0, &answer);
    }
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_SELECTED);
    assert_int_equal(vdna_select_restarts(select), 0);
    assert_int_equal(vdna_select_time(select)->late, 8);
}

static void a_gap_longer_than_a_warmup_by_time_begins_it_anew(void **state)
{
    (void)state;
    vdna_select *select = selector(by_time(1000));
    feed(select, 0, 0.5f, 0);
    feed(select, 900, 0.5f, 0);
    const vdna_select_answer answer = feed(select, 1901, 3.5f, 0);
    assert_int_equal(answer.restarted, VDNA_RESTART_GAP);
    assert_int_equal(vdna_select_window_frames(select), 1);
    assert_int_equal(vdna_select_first_utime(select), 1901);
    feed(select, 2500, 3.5f, 0);
    /* As long as the warmup is no gap. */
    assert_int_equal(feed(select, 3500, 3.5f, 0).newly_ranked, 1);
    assert_int_equal(vdna_select_chosen(select), 1);
}

static void a_gap_of_more_frames_than_the_warmup_begins_it_anew(void **state)
{
    (void)state;
    vdna_select *select = selector(by_frames(5));
    feed(select, 0, 0.5f, 0);
    feed(select, 4000000, 0.5f, 0);
    /* 5 times the spacing of 4 s. */
    assert_int_equal(feed(select, 24000000, 0.5f, 0).restarted, VDNA_RESTART_NONE);
    /* Now the spacing is 12 s. */
    assert_int_equal(feed(select, 96000000, 0.5f, 0).restarted, VDNA_RESTART_GAP);
    /* Less than 10 s is no gap at any spacing. */
    feed(select, 96000001, 0.5f, 0);
    assert_int_equal(feed(select, 105000000, 0.5f, 0).restarted, VDNA_RESTART_NONE);
}

static void a_warmup_by_time_goes_on_until_it_has_enough_frames(void **state)
{
    (void)state;
    vdna_select_config config = by_time(1000);
    config.warmup_frames_min = 4;
    vdna_select *select = selector(config);
    for (int64_t i = 0; i < 4; i++)
        assert_int_equal(feed(select, i * 600, 3.5f, 0).newly_ranked, 0);
    assert_true(vdna_select_progress(select) == 1);
    const vdna_select_answer answer = feed(select, 2400, 3.5f, 0);
    assert_int_equal(answer.newly_ranked, 1);
    assert_int_equal(answer.localised, 1);
    assert_int_equal(vdna_select_window_frames(select), 4);
}

static void nanoseconds_and_whole_seconds_fill_a_warmup_by_time(void **state)
{
    (void)state;
    const int64_t t0 = INT64_C(1700000000);
    vdna_select_config config = by_time(2000000);
    config.time_unit = VDNA_TIME_UNIT_AUTO;
    vdna_select *select = selector(config);
    for (int64_t i = 0; i < 20; i++)
        assert_int_equal(feed(select, t0 * 1000000000 + i * 100000000, 3.5f, 0).newly_ranked, 0);
    assert_int_equal(feed(select, t0 * 1000000000 + 2000000000, 3.5f, 0).newly_ranked, 1);
    assert_int_equal(vdna_select_window_frames(select), 20);

    select = selector(config);
    for (int64_t i = 0; i < 30; i++)
        assert_int_equal(feed(select, t0 + i / 10, 3.5f, 0).newly_ranked, 0);
    assert_int_equal(vdna_select_restarts(select), 1);
    assert_int_equal(vdna_select_restart_cause(select), VDNA_RESTART_UNIT);
    assert_string_equal(vdna_restart_text(VDNA_RESTART_UNIT),
                        "because the stamps are not microseconds");
    assert_string_equal(vdna_restart_text(VDNA_RESTART_BACKWARDS),
                        "because camera time stepped back");
    assert_string_equal(vdna_restart_text(VDNA_RESTART_GAP),
                        "because no frame came for longer than the warmup");
    assert_string_equal(vdna_restart_text(VDNA_RESTART_NONE), "");
    /* It began anew with the second second. */
    assert_int_equal(feed(select, t0 + 3, 3.5f, 0).newly_ranked, 1);
    assert_int_equal(vdna_select_window_frames(select), 20);
    assert_true(vdna_select_first_utime(select) == (t0 + 1) * 1000000);
}

static void a_refused_frame_changes_nothing_but_a_counter(void **state)
{
    (void)state;
    vdna_select *select = selector(by_frames(2));
    vdna_select_answer answer = {9, 9, 9, 9, {9, 9, 9}};
    const vdna_select_answer untouched = answer;
    feed(select, 0, 0.5f, 0);
    assert_int_equal(try_frame(select, 1, NAN, 0, &answer), VDNA_ERR_NONFINITE);
    assert_int_equal(try_frame(select, 1, 0.5f, INFINITY, &answer), VDNA_ERR_NONFINITE);
    assert_int_equal(vdna_select_feed(select, NULL, &answer), VDNA_ERR_ARG);
    assert_memory_equal(&answer, &untouched, sizeof answer);
    assert_int_equal(vdna_select_rejected(select), 3);
    assert_int_equal(vdna_select_accepted(select), 1);
    assert_int_equal(vdna_select_window_frames(select), 1);

    feed(select, 2, 0.5f, 0);
    assert_int_equal(try_frame(select, 3, 0.5f, NAN, &answer), VDNA_ERR_NONFINITE);
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_SELECTED);
}

static void a_window_that_is_too_large_to_rank_begins_anew(void **state)
{
    (void)state;
    /* The least common multiple of the masses, 10^7 and 2^32 - 1, times 65535 passes 63 bits. */
    static uint32_t counts[VDNA_HIST_BINS_MAX] = {10000000};
    static int64_t room[VDNA_HIST_BINS_MAX / 2 + 128];
    const vdna_select_candidate huge = {
        {range, counts, counts, 1, VDNA_HIST_BINS_MAX}, low_embeddings, 3, 0};
    vdna_select_config configs[] = {by_frames(2), by_time(1000)};
    for (size_t i = 0; i < 2; i++) {
        configs[i].candidates = &huge;
        configs[i].candidate_count = 1;
        vdna_select *select;
        vdna_select_answer answer;
        assert_int_equal(vdna_select_init(&configs[i], room, sizeof room, &select), VDNA_OK);
        feed(select, 0, 3.5f, 0);
        *live_mass(select) = UINT32_MAX - 1;
        assert_int_equal(try_frame(select, 1000, 3.5f, 0, &answer), VDNA_ERR_OVERFLOW);
        assert_int_equal(vdna_select_state(select), VDNA_SELECT_WARMUP);
        assert_int_equal(vdna_select_window_frames(select), 0);
        assert_int_equal(vdna_select_rejected(select), 1);
    }
}

static void a_window_whose_counts_are_full_begins_anew(void **state)
{
    (void)state;
    vdna_select *select = selector(by_frames(2));
    vdna_select_answer answer;
    feed(select, 0, 3.5f, 0);
    *live_mass(select) = UINT32_MAX;
    assert_int_equal(try_frame(select, 1, 3.5f, 0, &answer), VDNA_ERR_FULL);
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_WARMUP);
    assert_int_equal(vdna_select_window_frames(select), 0);
    assert_int_equal(*live_mass(select), 0);
}

static void embeddings_that_are_not_finite_localise_no_frame(void **state)
{
    (void)state;
    const float broken[] = {1, NAN};
    vdna_select_candidate only = candidates[1];
    only.embeddings = broken;
    vdna_select_config config = by_frames(1);
    config.candidates = &only;
    config.candidate_count = 1;
    vdna_select *select = selector(config);
    vdna_select_answer answer;
    feed(select, 0, 3.5f, 5);
    assert_int_equal(try_frame(select, 1, 3.5f, 5, &answer), VDNA_ERR_NONFINITE);
    assert_int_equal(vdna_select_rejected(select), 1);
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_SELECTED);
}

static void a_reset_warms_up_again_from_nothing(void **state)
{
    (void)state;
    vdna_select *select = selector(by_frames(1));
    feed(select, 0, 0.5f, 0);
    assert_int_equal(vdna_select_chosen(select), 0);
    vdna_select_reset(select);
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_WARMUP);
    assert_true(vdna_select_progress(select) == 0);
    /* Also with an earlier stamp: the old window is forgotten. */
    assert_int_equal(feed(select, -5, 3.5f, 0).restarted, 0);
    assert_int_equal(vdna_select_chosen(select), 1);
    assert_int_equal(vdna_select_accepted(select), 2);
}

static void a_single_candidate_is_chosen_with_margin_zero(void **state)
{
    (void)state;
    vdna_select_config config = by_frames(1);
    config.candidate_count = 1;
    vdna_select *select = selector(config);
    feed(select, 0, 3.5f, 0);
    assert_int_equal(vdna_select_chosen(select), 0);
    assert_true(vdna_select_margin_bins(select) == 0);
}

static void progress_runs_from_zero_to_one(void **state)
{
    (void)state;
    vdna_select *select = selector(by_frames(4));
    assert_true(vdna_select_progress(select) == 0);
    feed(select, 0, 1, 0);
    assert_true(vdna_select_progress(select) == 0.25);
    for (int i = 1; i < 4; i++)
        feed(select, i, 1, 0);
    assert_true(vdna_select_progress(select) == 1);

    select = selector(by_time(1000));
    feed(select, 100, 1, 0);
    feed(select, 600, 1, 0);
    assert_true(vdna_select_progress(select) == 0.5);

    /* Frames of the window are less than T after its first, so progress never passes 1. */
    select = selector(by_time(INT64_MAX));
    feed(select, 0, 1, 0);
    feed(select, INT64_MAX - 1, 1, 0);
    assert_true(vdna_select_progress(select) == 1);
    assert_true(vdna_select_progress(NULL) == 0);
}

static void candidates_that_do_not_compare_are_refused_at_init(void **state)
{
    (void)state;
    const float other_range[] = {0, 5};
    vdna_select_candidate pair[2];
    memcpy(pair, candidates, sizeof pair);
    pair[1].dna.range = other_range;
    vdna_select_config config = by_frames(1);
    config.candidates = pair;
    vdna_select *select;
    assert_int_equal(vdna_select_init(&config, block, sizeof block, &select), VDNA_ERR_MISMATCH);
}

static void candidates_need_not_be_within_the_exact_bound_of_one_another(void **state)
{
    (void)state;
    /* Only distances to the live window are ever computed, and its masses are small. */
    const uint32_t huge_low[BINS] = {UINT32_MAX}, huge_high[BINS] = {0, 0, 0, UINT32_MAX};
    const uint32_t huge = UINT32_MAX;
    vdna_select_candidate pair[2];
    memcpy(pair, candidates, sizeof pair);
    pair[0].dna.counts = huge_low;
    pair[1].dna.counts = huge_high;
    pair[0].dna.mass = pair[1].dna.mass = &huge;
    vdna_select_config config = by_frames(1);
    config.candidates = pair;
    vdna_select *select = selector(config);
    feed(select, 0, 3.5f, 5);
    assert_int_equal(vdna_select_chosen(select), 1);
    assert_true(vdna_select_margin_bins(select) == 3);
}

static void a_candidate_without_samples_is_refused_at_init(void **state)
{
    (void)state;
    const uint32_t none = 0;
    vdna_select_candidate pair[2];
    memcpy(pair, candidates, sizeof pair);
    pair[1].dna.mass = &none;
    vdna_select_config config = by_frames(1);
    config.candidates = pair;
    vdna_select *select;
    assert_int_equal(vdna_select_init(&config, block, sizeof block, &select), VDNA_ERR_EMPTY);
}

static void exactly_one_kind_of_warmup_must_be_given(void **state)
{
    (void)state;
    vdna_select_config config = by_frames(0);
    assert_int_equal(vdna_select_mem_size(&config), 0);
    config = by_frames(3);
    config.warmup_us = 1000;
    assert_int_equal(vdna_select_mem_size(&config), 0);
    config = by_frames(3);
    config.warmup_us = -1;
    assert_int_equal(vdna_select_mem_size(&config), 0);
}

static void the_block_may_not_be_a_byte_too_small_nor_misaligned(void **state)
{
    (void)state;
    const vdna_select_config config = by_frames(1);
    const size_t size = vdna_select_mem_size(&config);
    vdna_select *select;
    assert_true(size > 0 && size <= sizeof block - 1);
    assert_int_equal(vdna_select_init(&config, block, size - 1, &select), VDNA_ERR_NOMEM);
    assert_int_equal(vdna_select_init(&config, (char *)block + 4, size, &select), VDNA_ERR_ARG);
    assert_int_equal(vdna_select_init(&config, NULL, size, &select), VDNA_ERR_ARG);
    assert_int_equal(vdna_select_init(&config, block, size, &select), VDNA_OK);
}

static void places_beyond_the_exact_ones_have_bounds(void **state)
{
    (void)state;
    vdna_select_config config = by_frames(1);
    const size_t size = vdna_select_mem_size(&config);
    config.exact = 2; /* all */
    assert_int_equal(vdna_select_mem_size(&config), size);
    vdna_select *select = selector(config);
    feed(select, 100, 1.5f, 5);
    assert_int_equal(vdna_select_is_bound(select, 0) + vdna_select_is_bound(select, 1), 0);

    config.exact = 1;
    assert_true(vdna_select_mem_size(&config) > size);
    assert_int_equal(vdna_select_init(&config, block, vdna_select_mem_size(&config) - 1, &select),
                     VDNA_ERR_NOMEM);
    select = selector(config);
    assert_int_equal(vdna_select_is_bound(select, 1), 0);
    feed(select, 100, 1.5f, 5);
    const vdna_rank_entry *ranking = vdna_select_ranking(select, NULL);
    assert_int_equal(ranking[0].candidate, 0);
    assert_true(ranking[0].distance_bins == 1 && ranking[1].distance_bins == 2);
    assert_int_equal(vdna_select_is_bound(select, 0), 0);
    assert_int_equal(vdna_select_is_bound(select, 1), 1);
    assert_int_equal(vdna_select_is_bound(select, 2), 0);
    assert_int_equal(vdna_select_is_bound(NULL, 1), 0);
}

static void what_is_excluded_takes_no_exact_place(void **state)
{
    (void)state;
    vdna_select_config config = by_frames(1);
    config.exact = 1;
    vdna_select *select = selector(config);
    assert_int_equal(vdna_select_exclude(select, 0, 1), VDNA_OK);
    feed(select, 100, 1.5f, 5);
    assert_int_equal(vdna_select_chosen(select), 1);
    assert_int_equal(vdna_select_is_bound(select, 1), 0);
}

static void a_candidate_too_large_for_bounds_is_refused(void **state)
{
    (void)state;
    const uint32_t counts[BINS] = {UINT32_MAX / 3 + 1}, mass = counts[0];
    const vdna_select_candidate large[] = {candidates[0],
                                           {{range, counts, &mass, 1, BINS}, low_embeddings, 3, 0}};
    vdna_select_config config = by_frames(1);
    config.candidates = large;
    vdna_select *select = selector(config);
    config.exact = 1;
    assert_int_equal(vdna_select_init(&config, block, sizeof block, &select), VDNA_ERR_OVERFLOW);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_nth_frame_completes_a_warmup_by_frames),
        cmocka_unit_test(there_is_no_ranking_before_the_choice),
        cmocka_unit_test(a_selector_that_is_not_there_has_nothing),
        cmocka_unit_test(later_frames_are_localised_in_the_chosen_experience),
        cmocka_unit_test(later_frames_do_not_change_the_choice_nor_the_live_histogram),
        cmocka_unit_test(a_warmup_by_time_is_the_frames_before_first_plus_t),
        cmocka_unit_test(camera_time_that_runs_backwards_begins_the_warmup_anew),
        cmocka_unit_test(a_frame_that_cannot_be_localised_still_announces_the_choice),
        cmocka_unit_test(a_backward_stamp_does_not_end_a_warmup_by_time),
        cmocka_unit_test(a_late_frame_is_refused_and_counted_apart),
        cmocka_unit_test(frames_that_changed_places_do_not_keep_a_warmup_from_ending),
        cmocka_unit_test(a_gap_longer_than_a_warmup_by_time_begins_it_anew),
        cmocka_unit_test(a_gap_of_more_frames_than_the_warmup_begins_it_anew),
        cmocka_unit_test(a_warmup_by_time_goes_on_until_it_has_enough_frames),
        cmocka_unit_test(nanoseconds_and_whole_seconds_fill_a_warmup_by_time),
        cmocka_unit_test(a_refused_frame_changes_nothing_but_a_counter),
        cmocka_unit_test(a_window_that_is_too_large_to_rank_begins_anew),
        cmocka_unit_test(a_window_whose_counts_are_full_begins_anew),
        cmocka_unit_test(embeddings_that_are_not_finite_localise_no_frame),
        cmocka_unit_test(a_reset_warms_up_again_from_nothing),
        cmocka_unit_test(a_single_candidate_is_chosen_with_margin_zero),
        cmocka_unit_test(progress_runs_from_zero_to_one),
        cmocka_unit_test(candidates_that_do_not_compare_are_refused_at_init),
        cmocka_unit_test(candidates_need_not_be_within_the_exact_bound_of_one_another),
        cmocka_unit_test(a_candidate_without_samples_is_refused_at_init),
        cmocka_unit_test(exactly_one_kind_of_warmup_must_be_given),
        cmocka_unit_test(the_block_may_not_be_a_byte_too_small_nor_misaligned),
        cmocka_unit_test(places_beyond_the_exact_ones_have_bounds),
        cmocka_unit_test(what_is_excluded_takes_no_exact_place),
        cmocka_unit_test(a_candidate_too_large_for_bounds_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
