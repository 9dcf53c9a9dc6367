/* Arguments that break a stated rule of lib/core or lib/select are refused, and nothing changes. */
#include <math.h>
#include <string.h>

#include <vdna/select.h>

#include "cmocka_all.h"

/* One neuron in two bins over 0..1. */
static const float range[] = {0, 1};
static const uint32_t counts[] = {1, 2}, mass = 3;
static const vdna_hist_view view = {range, counts, &mass, 1, 2};
static const float embedding = 0.5f;
static uint32_t mem[8];

static vdna_hist_config hist_config(void)
{
    vdna_hist_config config;
    vdna_hist_config_init(&config);
    config.neurons = 1;
    config.bins = 2;
    config.range = range;
    return config;
}

static vdna_hist hist_with_a_frame(float value)
{
    const vdna_hist_config config = hist_config();
    const vdna_activations tap = {&value, 1, 1, 0};
    vdna_hist hist;
    assert_int_equal(vdna_hist_init(&config, mem, sizeof mem, &hist), VDNA_OK);
    assert_int_equal(vdna_hist_add(&hist, &tap, 1), VDNA_OK);
    return hist;
}

static void a_tap_without_samples_or_neurons_is_refused(void **state)
{
    (void)state;
    const float value = 0;
    const vdna_activations no_samples = {&value, 1, 0, 0}, no_neurons = {&value, 0, 1, 0};
    const vdna_activations no_values = {NULL, 1, 1, 0}, no_layout = {&value, 1, 1, 2};
    assert_int_equal(vdna_activations_check(&no_samples, 1, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_activations_check(&no_neurons, 1, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_activations_check(&no_values, 1, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_activations_check(&no_layout, 1, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_activations_check(NULL, 1, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_activations_check(&no_values, 0, 1), VDNA_ERR_ARG);
}

static void a_range_table_that_is_not_there_is_refused(void **state)
{
    (void)state;
    const float value = 0;
    const vdna_activations tap = {&value, 1, 1, 0};
    float kept[] = {0, 1};
    assert_int_equal(vdna_range_clear(NULL, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_range_clear(kept, 0), VDNA_ERR_ARG);
    assert_int_equal(vdna_range_check(NULL, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_range_check(kept, 0), VDNA_ERR_ARG);
    assert_int_equal(vdna_range_observe(NULL, 1, &tap, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_range_expand(NULL, 1, 2, 0), VDNA_ERR_ARG);
    assert_int_equal(vdna_range_expand(kept, 0, 2, 0), VDNA_ERR_ARG);
    assert_memory_equal(kept, range, sizeof kept);
}

static void both_edges_of_a_range_must_be_finite(void **state)
{
    (void)state;
    const float no_lo[] = {-INFINITY, 1}, no_hi[] = {0, INFINITY}, empty[] = {1, 1};
    assert_int_equal(vdna_range_check(no_lo, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_range_check(no_hi, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_range_check(empty, 1), VDNA_ERR_ARG);
}

static void either_edge_that_leaves_the_float_range_is_refused(void **state)
{
    (void)state;
    const float low[] = {-3e38f, 0}, high[] = {0, 3e38f};
    float widened[2];
    memcpy(widened, low, sizeof low);
    assert_int_equal(vdna_range_expand(widened, 1, 2, VDNA_RANGE_ABOUT_ZERO), VDNA_ERR_NONFINITE);
    assert_memory_equal(widened, low, sizeof low);
    memcpy(widened, high, sizeof high);
    assert_int_equal(vdna_range_expand(widened, 1, 2, VDNA_RANGE_ABOUT_ZERO), VDNA_ERR_NONFINITE);
    assert_memory_equal(widened, high, sizeof high);
}

static void a_histogram_without_config_block_or_place_is_refused(void **state)
{
    (void)state;
    vdna_hist_config config = hist_config();
    vdna_hist hist;
    assert_int_equal(vdna_hist_init(NULL, mem, sizeof mem, &hist), VDNA_ERR_ARG);
    assert_int_equal(vdna_hist_init(&config, NULL, sizeof mem, &hist), VDNA_ERR_ARG);
    assert_int_equal(vdna_hist_init(&config, mem, sizeof mem, NULL), VDNA_ERR_ARG);
    config.neurons = 0;
    assert_int_equal(vdna_hist_init(&config, mem, sizeof mem, &hist), VDNA_ERR_ARG);
    vdna_hist_config_init(NULL);
}

static void a_histogram_that_is_not_there_changes_nothing(void **state)
{
    (void)state;
    vdna_hist hist = hist_with_a_frame(0.9f);
    vdna_hist_view seen = view;
    assert_int_equal(vdna_hist_merge(&hist, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_hist_merge(NULL, &hist), VDNA_ERR_ARG);
    assert_int_equal(vdna_hist_subtract(&hist, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_hist_subtract(NULL, &hist), VDNA_ERR_ARG);
    vdna_hist_view_of(&hist, NULL);
    vdna_hist_view_of(NULL, &seen);
    vdna_hist_reset(NULL);
    assert_memory_equal(&seen, &view, sizeof view);
    assert_int_equal(hist.frames, 1);
    assert_int_equal(hist.counts[1], 1);
}

static void histograms_of_another_range_or_shape_do_not_merge(void **state)
{
    (void)state;
    const float other_range[] = {0, 2, 0, 2};
    const vdna_hist_config own = hist_config();
    vdna_hist_config configs[] = {own, own, own};
    configs[0].range = other_range;
    configs[1].bins = 3;
    configs[2].neurons = 2;
    configs[2].range = other_range;
    vdna_hist hist = hist_with_a_frame(0.9f), other;
    uint32_t other_mem[8];
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(vdna_hist_init(&configs[i], other_mem, sizeof other_mem, &other), VDNA_OK);
        assert_int_equal(vdna_hist_merge(&hist, &other), VDNA_ERR_MISMATCH);
        assert_int_equal(hist.frames, 1);
    }
}

static void a_view_that_is_no_histogram_has_no_distance(void **state)
{
    (void)state;
    vdna_hist_view bad[6] = {view, view, view, view, view, view};
    bad[0].range = NULL;
    bad[1].counts = NULL;
    bad[2].mass = NULL;
    bad[3].neurons = 0;
    bad[4].bins = VDNA_HIST_BINS_MIN - 1;
    bad[5].bins = VDNA_HIST_BINS_MAX + 1;
    int64_t scratch[2];
    double distance = 7;
    for (size_t i = 0; i < 6; i++) {
        assert_int_equal(vdna_emd(&bad[i], &view, scratch, sizeof scratch, &distance),
                         VDNA_ERR_ARG);
        assert_int_equal(vdna_emd_mean(&view, &bad[i], scratch, sizeof scratch, &distance),
                         VDNA_ERR_ARG);
    }
    assert_int_equal(vdna_emd(NULL, &view, scratch, sizeof scratch, &distance), VDNA_ERR_ARG);
    assert_int_equal(vdna_emd(&view, NULL, scratch, sizeof scratch, &distance), VDNA_ERR_ARG);
    assert_int_equal(vdna_emd(&view, &view, scratch, sizeof scratch, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_emd_mean(&view, &view, scratch, sizeof scratch, NULL), VDNA_ERR_ARG);
    assert_true(distance == 7);
}

static void a_ranking_needs_candidates_and_a_place(void **state)
{
    (void)state;
    int64_t scratch[2];
    vdna_rank_entry ranking = {7, 7, 7};
    assert_int_equal(vdna_rank(&view, NULL, 1, scratch, sizeof scratch, &ranking), VDNA_ERR_ARG);
    assert_int_equal(vdna_rank(&view, &view, 0, scratch, sizeof scratch, &ranking), VDNA_ERR_ARG);
    assert_int_equal(vdna_rank(&view, &view, 1, scratch, sizeof scratch, NULL), VDNA_ERR_ARG);
    assert_int_equal(ranking.candidate, 7);
}

static const vdna_select_candidate candidate = {{range, counts, &mass, 1, 2}, &embedding, 1, 0};

static vdna_select_config select_config(const vdna_select_candidate *only)
{
    vdna_select_config config;
    vdna_select_config_init(&config);
    config.candidates = only;
    config.candidate_count = 1;
    config.dim = 1;
    config.warmup_frames = 1;
    return config;
}

static void the_function_behind_the_macro_writes_what_version_0_1_had(void **state)
{
    (void)state;
    vdna_select_config config;
    memset(&config, 0xAA, sizeof config);
    (vdna_select_config_init)(&config);
    assert_int_equal(config.struct_size, offsetof(vdna_select_config, late_us));
    assert_int_equal(config.warmup_frames, 0);
    assert_int_equal(config.time_unit, 0xAAAAAAAA);
}

static void an_incomplete_config_of_a_selector_is_refused(void **state)
{
    (void)state;
    const vdna_select_config good = select_config(&candidate);
    vdna_select_config bad[7] = {good, good, good, good, good, good, good};
    bad[0].struct_size = offsetof(vdna_select_config, late_us) - 1;
    bad[1].candidates = NULL;
    bad[2].candidate_count = 0;
    bad[3].dim = 0;
    bad[4].struct_size++;
    bad[5].late_us = -1;
    bad[6].time_unit = VDNA_TIME_UNIT_S + 1;
    int64_t block[256];
    vdna_select *select;
    assert_true(vdna_select_mem_size(&good) > 0);
    for (size_t i = 0; i < 7; i++) {
        assert_int_equal(vdna_select_mem_size(&bad[i]), 0);
        assert_int_equal(vdna_select_init(&bad[i], block, sizeof block, &select), VDNA_ERR_ARG);
    }
    assert_int_equal(vdna_select_mem_size(NULL), 0);
    assert_int_equal(vdna_select_init(&good, block, sizeof block, NULL), VDNA_ERR_ARG);
    vdna_select_config_init(NULL);
}

static void a_candidate_that_cannot_be_chosen_is_refused(void **state)
{
    (void)state;
    const float constant[] = {1, 1};
    vdna_select_candidate bad[4] = {candidate, candidate, candidate, candidate};
    bad[0].embeddings = NULL;
    bad[1].frames = 0;
    bad[2].dna.neurons = 0;
    bad[3].dna.range = constant;
    int64_t block[256];
    vdna_select *select;
    for (size_t i = 0; i < 4; i++) {
        const vdna_select_config config = select_config(&bad[i]);
        assert_int_equal(vdna_select_init(&config, block, sizeof block, &select), VDNA_ERR_ARG);
    }
}

static void a_selector_frame_or_answer_that_is_not_there_is_refused(void **state)
{
    (void)state;
    const vdna_select_config config = select_config(&candidate);
    const vdna_activations tap = {&embedding, 1, 1, 0};
    const vdna_select_frame frame = {0, &tap, 1, &embedding}, bare = {0, &tap, 1, NULL};
    int64_t block[256];
    vdna_select *select;
    vdna_select_answer answer;
    assert_int_equal(vdna_select_init(&config, block, sizeof block, &select), VDNA_OK);
    assert_int_equal(vdna_select_feed(NULL, &frame, &answer), VDNA_ERR_ARG);
    assert_int_equal(vdna_select_feed(select, &frame, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_select_accepted(select) + vdna_select_rejected(select), 0);
    assert_int_equal(vdna_select_feed(select, NULL, &answer), VDNA_ERR_ARG);
    assert_int_equal(vdna_select_feed(select, &bare, &answer), VDNA_ERR_ARG);
    assert_int_equal(vdna_select_rejected(select), 2);
    vdna_select_reset(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tap_without_samples_or_neurons_is_refused),
        cmocka_unit_test(a_range_table_that_is_not_there_is_refused),
        cmocka_unit_test(both_edges_of_a_range_must_be_finite),
        cmocka_unit_test(either_edge_that_leaves_the_float_range_is_refused),
        cmocka_unit_test(a_histogram_without_config_block_or_place_is_refused),
        cmocka_unit_test(a_histogram_that_is_not_there_changes_nothing),
        cmocka_unit_test(histograms_of_another_range_or_shape_do_not_merge),
        cmocka_unit_test(a_view_that_is_no_histogram_has_no_distance),
        cmocka_unit_test(a_ranking_needs_candidates_and_a_place),
        cmocka_unit_test(the_function_behind_the_macro_writes_what_version_0_1_had),
        cmocka_unit_test(an_incomplete_config_of_a_selector_is_refused),
        cmocka_unit_test(a_candidate_that_cannot_be_chosen_is_refused),
        cmocka_unit_test(a_selector_frame_or_answer_that_is_not_there_is_refused),
    };
    return cmocka_run_group_tests_name("arguments", tests, NULL, NULL);
}
