/* A selector with trust in its choice: none fits, early stops, orders, and what is refused. */
#include <math.h>
#include <string.h>

#include <vdna/select.h>

#include "cmocka_all.h"

#define OK(call) assert_int_equal((call), VDNA_OK)

/* Experience b has two frames, which look into direction b, and all its samples in bin b: the live
 * one is as far from it as its direction and its bin are. As far as stored runs can tell, a run is
 * 0.1 from its nearest, so twice that is unlike. */
enum { RUNS = 6, DIM = 2, LAST = 3, BINS = 8, WINDOWS = VDNA_TRUST_WINDOWS };
static const float step = 0.05f, range[] = {0, BINS};

static struct {
    float embeddings[RUNS][2 * DIM];
    int8_t codes[RUNS][2 * LAST];
    float scales[2];
    uint32_t counts[RUNS][BINS], mass, frames[RUNS];
    double own[RUNS], correlation[RUNS];
    vdna_trust_cell cells[RUNS * RUNS];
    vdna_select_candidate candidates[RUNS];
    vdna_trust_run runs[RUNS];
} map;
static vdna_trust_tables tables;
static vdna_trust *trust;
static int64_t trust_block[1024], block[512];

static void make_run(uint32_t b)
{
    const float at = step * (float)b;
    const float frames[] = {1, at, 2, 2 * at};
    const int8_t codes[] = {100, 0, (int8_t)(10 * b), 100, 0, (int8_t)(10 * b)};
    memcpy(map.embeddings[b], frames, sizeof frames);
    memcpy(map.codes[b], codes, sizeof codes);
    memset(map.counts[b], 0, sizeof map.counts[b]);
    map.counts[b][b] = map.mass = 4;
    map.scales[0] = map.scales[1] = 1;
    const vdna_select_candidate candidate = {
        {range, map.counts[b], &map.mass, 1, BINS}, map.embeddings[b], 2, 0};
    const vdna_trust_run run = {
        map.embeddings[b], map.codes[b], map.scales, NULL, NULL, NULL, 2, DIM, LAST, 0};
    map.candidates[b] = candidate;
    map.runs[b] = run;
    map.frames[b] = 30;
    map.own[b] = 0.5;
    map.correlation[b] = 1;
}

/* Neighbours localise each other well. The last layer is not known. */
static void make_map(uint32_t count)
{
    for (uint32_t b = 0; b < RUNS; b++)
        make_run(b);
    for (uint32_t a = 0; a < count; a++)
        for (uint32_t b = 0; b < count; b++)
            for (uint32_t i = 0; i < WINDOWS; i++) {
                vdna_trust_cell *cell = &map.cells[a * count + b];
                const double apart = fabs((double)a - b);
                cell->nearest[i] = 0.1 * apart;
                cell->likeness[i] = NAN;
                cell->recall[i] = 1 - 0.1 * apart;
                cell->distance[i] = apart;
            }
}

static void set_recall(uint32_t count, double of_first, double of_others)
{
    for (uint32_t i = 0; i < count * count; i++)
        for (uint32_t w = 0; w < WINDOWS; w++)
            map.cells[i].recall[w] = i % count == 0 ? of_first : of_others;
}

static void make_trust(uint32_t count, double min_recall)
{
    tables = (vdna_trust_tables){map.frames, map.own, map.correlation, map.cells};
    vdna_trust_config config;
    vdna_trust_config_init(&config);
    config.runs = count;
    config.tables = &tables;
    config.min_recall = min_recall;
    OK(vdna_trust_init(&config, trust_block, sizeof trust_block, &trust));
}

static vdna_select_config config_of(uint32_t count, uint32_t frames)
{
    vdna_select_config config;
    vdna_select_config_init(&config);
    config.candidates = map.candidates;
    config.candidate_count = count;
    config.dim = DIM;
    config.warmup_frames = frames;
    config.late_us = 0;
    config.time_unit = VDNA_TIME_UNIT_US;
    config.trust = trust;
    config.runs = map.runs;
    return config;
}

static vdna_select *made(const vdna_select_config *config)
{
    vdna_select *select;
    OK(vdna_select_init(config, block, sizeof block, &select));
    return select;
}

/* Of three experiences, warming up by five frames. */
static vdna_select *small_selector(void)
{
    make_map(3);
    make_trust(3, 0);
    const vdna_select_config config = config_of(3, 5);
    return made(&config);
}

static vdna_status try_frame(vdna_select *select, int64_t utime, double direction, double bin,
                             const float *last_layer, vdna_select_answer *answer)
{
    const float embedding[DIM] = {1, (float)(step * direction)}, activation = (float)(bin + 0.5);
    const vdna_activations tap = {&activation, 1, 1, 0};
    const vdna_select_frame frame = {utime, &tap, 1, embedding};
    return vdna_select_feed_seen(select, &frame, last_layer, answer);
}

static int64_t now; /* microseconds; no test depends on where it begins */

static vdna_select_answer feed(vdna_select *select, double direction, double bin)
{
    vdna_select_answer answer;
    now += 1000;
    OK(try_frame(select, now, direction, bin, NULL, &answer));
    return answer;
}

/* The last answer. */
static vdna_select_answer feed_many(vdna_select *select, uint32_t frames, double direction,
                                    double bin)
{
    for (uint32_t i = 1; i < frames; i++)
        assert_int_equal(feed(select, direction, bin).newly_ranked, 0);
    return feed(select, direction, bin);
}

enum { FAR_OFF = 9 }; /* a direction that is unlike all */

/* ---- None fits ---- */

static void a_live_run_unlike_all_gets_the_least_bad_and_is_told(void **state)
{
    (void)state;
    vdna_select *select = small_selector();
    assert_null(vdna_select_trust(select));
    uint32_t count = 7;
    assert_null(vdna_select_predictions(select, &count));
    assert_int_equal(count, 0);
    const vdna_select_answer answer = feed_many(select, 5, FAR_OFF, 2);
    assert_int_equal(answer.state, VDNA_SELECT_NONE_FITS);
    assert_int_equal(answer.newly_ranked, 1);
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_NONE_FITS);
    assert_int_equal(vdna_select_trust(select)->verdict, VDNA_TRUST_UNLIKE);
    assert_int_equal(vdna_select_trust(select)->frames, 5);
    assert_int_equal(vdna_select_predictions(select, NULL)[2].reason, VDNA_TRUST_REASON_UNLIKE);
    assert_non_null(vdna_select_predictions(select, &count));
    assert_int_equal(count, 3);
    assert_int_equal(vdna_select_chosen(select), 2);
    assert_int_equal(vdna_select_ranking(select, NULL)[1].candidate, 1);
    assert_true(vdna_select_margin_bins(select) == 1);
    assert_true(vdna_select_progress(select) == 1);
    assert_int_equal(vdna_select_window_frames(select), 5);
    assert_null(vdna_select_where(select)); /* which localisers tell */
}

static void once_it_becomes_alike_another_choice_is_made(void **state)
{
    (void)state;
    vdna_select *select = small_selector();
    feed_many(select, 5, FAR_OFF, 2);
    /* Half of the next warmup is still unlike, so that its mean is. */
    for (int i = 0; i < 3; i++) {
        const vdna_select_answer answer = feed(select, FAR_OFF, 2);
        assert_int_equal(answer.newly_ranked, 0);
        assert_int_equal(answer.localised, 1);
        assert_int_equal(answer.state, VDNA_SELECT_NONE_FITS);
        assert_true(vdna_select_progress(select) == (i + 1) / 5.0);
    }
    assert_int_equal(vdna_select_window_frames(select), 3);
    assert_int_equal(vdna_select_chosen(select), 2);
    vdna_select_answer answer = feed_many(select, 2, 0, 0);
    assert_int_equal(answer.newly_ranked, 1);
    assert_int_equal(answer.state, VDNA_SELECT_NONE_FITS);

    answer = feed_many(select, 5, 0, 0);
    assert_int_equal(answer.newly_ranked, 1);
    assert_int_equal(answer.state, VDNA_SELECT_SELECTED);
    assert_int_equal(answer.localised, 1);
    assert_true(answer.match.distance_sq == 0); /* in the new choice */
    assert_int_equal(vdna_select_chosen(select), 0);
    assert_int_equal(vdna_select_trust(select)->verdict, VDNA_TRUST_FITS);
    assert_int_equal(vdna_select_switches(select), 0);

    /* For good. */
    for (int i = 0; i < 20; i++)
        assert_int_equal(feed(select, FAR_OFF, 2).newly_ranked, 0);
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_SELECTED);
}

static void a_choice_that_promises_too_little_does_not_fit(void **state)
{
    (void)state;
    make_map(3);
    set_recall(3, 0.3, 0.3);
    make_trust(3, 0.9);
    vdna_select_config config = config_of(3, 5);
    vdna_select *select = made(&config);
    assert_int_equal(feed_many(select, 5, 3, 2).state, VDNA_SELECT_NONE_FITS);
    assert_int_equal(vdna_select_trust(select)->verdict, VDNA_TRUST_POOR);
    assert_in_range(100 * vdna_select_predictions(select, NULL)[2].recall, 80, 90);
    make_trust(3, 0.8);
    config = config_of(3, 5);
    select = made(&config);
    assert_int_equal(feed_many(select, 5, 3, 2).state, VDNA_SELECT_SELECTED);
}

static void time_that_steps_back_begins_the_next_warmup_anew_and_leaves_the_choice(void **state)
{
    (void)state;
    vdna_select *select = small_selector();
    feed_many(select, 5, FAR_OFF, 2);
    /* Before a frame of the next warmup there is no gap in it. */
    now += 60000000;
    assert_int_equal(feed(select, 0, 0).restarted, VDNA_RESTART_NONE);
    feed(select, 0, 0);
    vdna_select_answer answer;
    now -= 5000;
    OK(try_frame(select, now, 0, 0, NULL, &answer));
    assert_int_equal(answer.restarted, VDNA_RESTART_BACKWARDS);
    assert_int_equal(answer.state, VDNA_SELECT_NONE_FITS);
    assert_int_equal(answer.localised, 1);
    assert_int_equal(vdna_select_restarts(select), 1);
    assert_int_equal(vdna_select_window_frames(select), 1);
    assert_int_equal(vdna_select_chosen(select), 2);
    assert_int_equal(feed_many(select, 4, 0, 0).newly_ranked, 1);
}

static void a_frame_that_ends_a_warmup_by_time_is_not_in_it_and_begins_no_other(void **state)
{
    (void)state;
    make_map(3);
    make_trust(3, 0);
    vdna_select_config config = config_of(3, 0);
    config.warmup_us = 5000;
    config.warmup_frames_min = 1;
    vdna_select *select = made(&config);
    vdna_select_answer answer = feed_many(select, 6, FAR_OFF, 2);
    assert_int_equal(answer.newly_ranked, 1);
    assert_int_equal(answer.localised, 1);
    assert_int_equal(vdna_select_trust(select)->frames, 5);
    answer = feed_many(select, 6, 0, 0);
    assert_int_equal(answer.newly_ranked, 1);
    assert_int_equal(answer.state, VDNA_SELECT_SELECTED);
    assert_int_equal(vdna_select_trust(select)->frames, 5);
}

static void a_reset_forgets_that_none_fits(void **state)
{
    (void)state;
    vdna_select *select = small_selector();
    feed_many(select, 5, FAR_OFF, 2);
    feed(select, FAR_OFF, 2);
    vdna_select_reset(select);
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_WARMUP);
    assert_null(vdna_select_trust(select));
    assert_int_equal(vdna_select_chosen(select), 0);
    assert_true(vdna_select_progress(select) == 0);
    feed_many(select, 5, 0, 0);
    assert_int_equal(vdna_select_trust(select)->frames, 5);
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_SELECTED);
}

static void a_next_warmup_that_cannot_be_counted_begins_all_anew(void **state)
{
    (void)state;
    vdna_select *select = small_selector();
    feed_many(select, 5, FAR_OFF, 2);
    feed(select, FAR_OFF, 2);
    vdna_hist_view live;
    vdna_select_live(select, &live);
    *(uint32_t *)live.mass = UINT32_MAX; /* which no test has time to count to */
    vdna_select_answer answer;
    assert_int_equal(try_frame(select, now + 1, 0, 0, NULL, &answer), VDNA_ERR_FULL);
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_WARMUP);
    assert_null(vdna_select_ranking(select, NULL));
}

/* ---- Early stops ---- */

static uint32_t frames_until_chosen(const vdna_select_config *config, double bin,
                                    uint32_t *out_chosen)
{
    vdna_select *select = made(config);
    uint32_t frames = 1;
    while (feed(select, 1.1 + 0.1 * (frames % 3), bin).newly_ranked == 0)
        frames++;
    *out_chosen = vdna_select_chosen(select);
    return frames;
}

static void a_choice_that_has_settled_comes_early_and_is_that_of_the_whole_warmup(void **state)
{
    (void)state;
    make_map(3);
    make_trust(3, 0);
    vdna_select_config config = config_of(3, 40);
    uint32_t whole, early;
    assert_int_equal(frames_until_chosen(&config, 1, &whole), 40);
    assert_int_equal(vdna_select_is_early((const vdna_select *)block), 0);
    config.stop_early = 1;
    assert_int_equal(frames_until_chosen(&config, 1, &early), VDNA_TRUST_SETTLED_FRAMES);
    assert_int_equal(early, whole);
    const vdna_select *select = (const vdna_select *)block;
    assert_int_equal(vdna_select_trust(select)->settled_frames, VDNA_TRUST_SETTLED_FRAMES);
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_SELECTED);
    assert_true(vdna_select_progress(select) == 1);
    assert_int_equal(vdna_select_ranked_by(select), VDNA_SELECT_BY_RELATIVE);
    assert_int_equal(vdna_select_is_early(select), 1);
    vdna_select_reset((vdna_select *)block);
    assert_int_equal(vdna_select_is_early(select), 0);
    assert_int_equal(vdna_select_is_early(NULL), 0);
}

static void an_early_choice_by_transfer_waits_for_twenty_frames(void **state)
{
    (void)state;
    make_map(3);
    make_trust(3, 0);
    vdna_select_config config = config_of(3, 40);
    config.rank = VDNA_SELECT_BY_TRANSFER;
    uint32_t whole, early;
    assert_int_equal(frames_until_chosen(&config, 0, &whole), 40);
    config.stop_early = 1;
    assert_int_equal(frames_until_chosen(&config, 0, &early), 20);
    const vdna_select *select = (const vdna_select *)block;
    assert_int_equal(vdna_select_ranked_by(select), VDNA_SELECT_BY_TRANSFER);
    assert_int_equal(vdna_select_is_early(select), 1);
    assert_int_equal(early, whole);
    assert_int_not_equal(early, vdna_select_trust(select)->choice); /* of the scores */

    map.cells[1].recall[0] = NAN; /* so one run is not labelled: there is no transfer of all */
    make_trust(3, 0);
    assert_int_equal(frames_until_chosen(&config, 0, &early), VDNA_TRUST_SETTLED_FRAMES);
    assert_int_equal(vdna_select_ranked_by(select), VDNA_SELECT_BY_RELATIVE);
}

static void an_early_choice_is_in_the_order_of_the_scores(void **state)
{
    (void)state;
    make_map(3);
    make_trust(3, 0);
    vdna_select_config config = config_of(3, 40);
    config.stop_early = 1;
    vdna_select *select = made(&config);
    feed_many(select, VDNA_TRUST_SETTLED_FRAMES, 2.1, 0); /* the Visual DNA says otherwise */
    const vdna_rank_entry *ranking = vdna_select_ranking(select, NULL);
    const vdna_trust_prediction *of = vdna_select_predictions(select, NULL);
    assert_int_equal(vdna_select_chosen(select), 2);
    for (uint32_t i = 0; i < 3; i++) {
        assert_int_equal(ranking[i].candidate, 2 - i);
        assert_true(ranking[i].distance_bins == 2 - i);
        assert_int_equal(ranking[i].tied, 0);
    }
    assert_true(of[2].score > of[1].score && of[1].score > of[0].score);
    assert_true(vdna_select_margin_bins(select) == -1);
}

static void nothing_stops_early_where_distances_say_nothing(void **state)
{
    (void)state;
    make_map(RUNS);
    set_recall(RUNS, 0.9, 0.5); /* whatever the distance */
    make_trust(RUNS, 0);
    assert_true(vdna_trust_fitted(trust)->skill <= 0);
    vdna_select_config config = config_of(RUNS, 40);
    config.stop_early = 1;
    uint32_t chosen;
    assert_int_equal(frames_until_chosen(&config, 1, &chosen), 40);
    assert_int_equal(vdna_select_ranked_by((vdna_select *)block), VDNA_SELECT_BY_EMD);
}

static void none_stops_early_without_trust(void **state)
{
    (void)state;
    make_map(3);
    vdna_select_config config = config_of(3, 40);
    config.stop_early = 1;
    config.trust = NULL;
    uint32_t chosen;
    assert_int_equal(frames_until_chosen(&config, 1, &chosen), 40);
    uint32_t count = 7;
    assert_null(vdna_select_trust((vdna_select *)block));
    assert_null(vdna_select_predictions((vdna_select *)block, &count));
    assert_int_equal(count, 0);
}

static void a_choice_that_settles_with_the_last_frame_is_not_early(void **state)
{
    (void)state;
    make_map(3);
    make_trust(3, 0);
    vdna_select_config config = config_of(3, VDNA_TRUST_SETTLED_FRAMES);
    config.stop_early = 1;
    uint32_t chosen;
    assert_int_equal(frames_until_chosen(&config, 1, &chosen), VDNA_TRUST_SETTLED_FRAMES);
    assert_int_equal(vdna_select_ranked_by((vdna_select *)block), VDNA_SELECT_BY_EMD);
}

static void while_none_fits_every_warmup_is_whole(void **state)
{
    (void)state;
    make_map(3);
    make_trust(3, 0);
    vdna_select_config config = config_of(3, 40);
    config.stop_early = 1;
    vdna_select *select = made(&config);
    vdna_select_answer answer = feed_many(select, VDNA_TRUST_SETTLED_FRAMES, FAR_OFF, 2);
    assert_int_equal(answer.state, VDNA_SELECT_NONE_FITS);
    assert_true(vdna_select_progress(select) == 1);
    answer = feed_many(select, 40, 1.1, 1);
    assert_int_equal(answer.state, VDNA_SELECT_SELECTED);
    assert_int_equal(vdna_select_window_frames(select), 40);
}

/* ---- Orders ---- */

static void a_ranking_by_transfer_puts_first_who_did_well_for_the_like(void **state)
{
    (void)state;
    make_map(3);
    set_recall(3, 0.9, 0.2); /* everyone does well in the first */
    make_trust(3, 0);
    vdna_select_config config = config_of(3, 5);
    vdna_select *select = made(&config);
    feed_many(select, 5, 2.1, 2);
    assert_int_equal(vdna_select_ranked_by(select), VDNA_SELECT_BY_EMD);
    assert_int_equal(vdna_select_ranking(select, NULL)[1].candidate, 1);

    config.rank = VDNA_SELECT_BY_TRANSFER;
    for (uint32_t i = 0; i < 3; i++) /* what the third did in itself counts most */
        for (uint32_t w = 0; w < WINDOWS; w++)
            map.cells[2 * 3 + i].recall[w] = i == 0 ? 0.9 : 0.2;
    select = made(&config);
    feed_many(select, 5, 2.1, 2);
    const vdna_trust_prediction *of = vdna_select_predictions(select, NULL);
    const vdna_rank_entry *ranking = vdna_select_ranking(select, NULL);
    assert_int_equal(vdna_select_ranked_by(select), VDNA_SELECT_BY_TRANSFER);
    assert_int_equal(vdna_select_chosen(select), 2);
    assert_int_equal(ranking[1].candidate, 0);
    assert_true(of[2].transfer > of[0].transfer && of[0].transfer > of[1].transfer);
    assert_true(vdna_select_margin_bins(select) == 2);
    assert_int_equal(ranking[0].tied + ranking[1].tied + ranking[2].tied, 0);
}

static void of_the_same_transfer_the_nearer_is_first_and_only_the_same_distance_ties(void **state)
{
    (void)state;
    make_map(4);
    set_recall(4, 1, 1);
    make_trust(4, 0);
    vdna_select_config config = config_of(4, 4);
    config.rank = VDNA_SELECT_BY_TRANSFER;
    vdna_select *select = made(&config);
    feed_many(select, 4, 1.5, 2);
    const vdna_rank_entry *ranking = vdna_select_ranking(select, NULL);
    const uint32_t order[] = {2, 1, 3, 0}, tied[] = {0, 1, 1, 0};
    for (uint32_t i = 0; i < 4; i++) {
        assert_int_equal(ranking[i].candidate, order[i]);
        assert_int_equal(ranking[i].tied, tied[i]);
    }
}

/* Everyone does well in the first, less so in the second, badly in the third, and all are so far
 * apart that each has a say. */
static void make_favourites(void)
{
    static const double recalls[] = {1, 0.6, 0};
    make_map(3);
    for (uint32_t i = 0; i < 9; i++)
        for (uint32_t w = 0; w < WINDOWS; w++) {
            map.cells[i].recall[w] = recalls[i % 3];
            map.cells[i].distance[w] *= 100;
        }
    make_trust(3, 0);
}

static void the_first_by_transfer_has_its_distance_though_others_are_nearer(void **state)
{
    (void)state;
    make_favourites();
    vdna_select_config config = config_of(3, 5);
    config.rank = VDNA_SELECT_BY_TRANSFER;
    for (config.exact = 1; config.exact <= 3; config.exact += 2) {
        vdna_select *select = made(&config);
        feed_many(select, 5, 2.1, 2);
        const vdna_rank_entry *ranking = vdna_select_ranking(select, NULL);
        assert_int_equal(vdna_select_ranked_by(select), VDNA_SELECT_BY_TRANSFER);
        for (uint32_t i = 0; i < 3; i++) {
            assert_int_equal(ranking[i].candidate, i);
            assert_true(ranking[i].distance_bins == 2 - i);
            assert_int_equal(vdna_select_is_bound(select, i), config.exact == 1 && i == 1);
        }
    }
}

static void a_bound_ties_with_nothing(void **state)
{
    (void)state;
    make_map(4);
    set_recall(4, 1, 1);
    make_trust(4, 0);
    vdna_select_config config = config_of(4, 4);
    config.rank = VDNA_SELECT_BY_TRANSFER;
    config.exact = 1;
    vdna_select *select = made(&config);
    feed_many(select, 4, 1.5, 2);
    const vdna_rank_entry *ranking = vdna_select_ranking(select, NULL);
    assert_int_equal(ranking[1].candidate, 1);
    assert_int_equal(ranking[2].candidate, 3);
    assert_int_equal(vdna_select_is_bound(select, 1) + vdna_select_is_bound(select, 3), 2);
    assert_int_equal(ranking[1].tied + ranking[2].tied, 0);
}

static void without_labels_the_distance_ranks(void **state)
{
    (void)state;
    make_map(3);
    set_recall(3, NAN, NAN);
    make_trust(3, 0);
    vdna_select_config config = config_of(3, 5);
    config.rank = VDNA_SELECT_BY_TRANSFER;
    vdna_select *select = made(&config);
    feed_many(select, 5, 2.1, 2);
    assert_int_equal(vdna_select_ranked_by(select), VDNA_SELECT_BY_EMD);
    assert_int_equal(vdna_select_chosen(select), 2);
    assert_int_equal(vdna_select_predictions(select, NULL)[0].reason, VDNA_TRUST_REASON_FEW_RUNS);
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_SELECTED);
}

static void trust_does_not_change_what_distance_ranks(void **state)
{
    (void)state;
    vdna_select *select = small_selector();
    feed_many(select, 5, 0.5, 1);
    vdna_rank_entry with[3];
    memcpy(with, vdna_select_ranking(select, NULL), sizeof with);
    vdna_select_config config = config_of(3, 5);
    config.trust = NULL;
    select = made(&config);
    feed_many(select, 5, 0.5, 1);
    assert_memory_equal(with, vdna_select_ranking(select, NULL), sizeof with);
    assert_int_equal(with[1].tied + with[2].tied, 2);
}

/* ---- The last layer ---- */

static void make_likeness(double all)
{
    for (uint32_t i = 0; i < 9; i++)
        for (uint32_t w = 0; w < WINDOWS; w++)
            map.cells[i].likeness[w] = all;
}

static void the_last_layer_judges_if_all_runs_have_it(void **state)
{
    (void)state;
    make_map(3);
    make_likeness(0.1);
    make_trust(3, 0);
    const vdna_select_config config = config_of(3, 5);
    vdna_select *select = made(&config);
    const float alike[] = {100, 0, 3}, unlike[] = {0, 100, 0}, bad[] = {0, NAN, 0};
    vdna_select_answer answer;
    assert_int_equal(try_frame(select, 1, 0, 0, NULL, &answer), VDNA_ERR_ARG);
    assert_int_equal(try_frame(select, 1, 0, 0, bad, &answer), VDNA_ERR_NONFINITE);
    assert_int_equal(vdna_select_rejected(select), 2);
    assert_int_equal(vdna_select_window_frames(select), 0);
    for (int i = 1; i <= 5; i++)
        OK(try_frame(select, i, 0, 0, unlike, &answer));
    assert_int_equal(answer.state, VDNA_SELECT_NONE_FITS);
    for (int i = 6; i <= 10; i++)
        OK(try_frame(select, i, 0, 0, alike, &answer));
    assert_int_equal(answer.state, VDNA_SELECT_SELECTED);
    assert_true(vdna_select_trust(select)->unlike < 0);
}

/* ---- What is refused ---- */

static void a_map_that_cannot_be_measured_refuses_the_frame_whole(void **state)
{
    (void)state;
    vdna_select *select = small_selector();
    feed(select, 0, 0);
    map.embeddings[1][0] = map.embeddings[1][2] = NAN;
    vdna_select_answer answer;
    assert_int_equal(try_frame(select, now + 1, 0, 0, NULL, &answer), VDNA_ERR_NONFINITE);
    assert_int_equal(vdna_select_window_frames(select), 1);
    make_map(3);
    make_likeness(0.1);
    make_trust(3, 0);
    const vdna_select_config config = config_of(3, 5);
    select = made(&config);
    map.scales[0] = -1;
    const float last_layer[] = {100, 0, 3};
    assert_int_equal(try_frame(select, now + 1, 0, 0, last_layer, &answer), VDNA_ERR_NONFINITE);
    assert_int_equal(vdna_select_window_frames(select), 0);
}

static void assert_refused(const vdna_select_config *config)
{
    vdna_select *select;
    assert_int_equal(vdna_select_mem_size(config), 0);
    assert_int_equal(vdna_select_init(config, block, sizeof block, &select), VDNA_ERR_ARG);
}

static void a_config_that_does_not_go_together_is_refused(void **state)
{
    (void)state;
    make_map(3);
    make_trust(3, 0);
    const vdna_select_config good = config_of(3, 5);
    vdna_select_config bad[] = {good, good, good, good, good, good};
    bad[0].rank = VDNA_SELECT_BY_RELATIVE;
    bad[1].stop_early = 2;
    bad[2].reselect = 2;
    bad[3].reselect = 1; /* without localisers */
    bad[4].runs = NULL;
    bad[5].candidate_count = 2;
    assert_true(vdna_select_mem_size(&good) > 0);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_refused(&bad[i]);
    bad[3].trust = NULL;
    assert_refused(&bad[3]);
}

static void runs_that_are_not_those_of_the_candidates_are_refused(void **state)
{
    (void)state;
    make_map(3);
    make_trust(3, 0);
    const vdna_select_config config = config_of(3, 5);
    map.runs[2].embeddings = NULL;
    assert_refused(&config);
    make_run(2);
    map.runs[2].frames = 1;
    assert_refused(&config);
    make_run(2);
    map.runs[2].dim = 1;
    assert_refused(&config);
    make_run(2);
    map.runs[2].last_layer = NULL; /* which is not needed */
    assert_true(vdna_select_mem_size(&config) > 0);
}

static void runs_need_the_last_layer_that_trust_judges_by(void **state)
{
    (void)state;
    make_map(3);
    make_likeness(0.1);
    make_trust(3, 0);
    const vdna_select_config config = config_of(3, 5);
    assert_true(vdna_select_mem_size(&config) > 0);
    map.runs[2].last_layer = NULL;
    assert_refused(&config);
    make_run(2);
    map.runs[2].last_layer_scale = NULL;
    assert_refused(&config);
    make_run(2);
    map.runs[2].last_layer_dim = LAST - 1;
    assert_refused(&config);
    for (uint32_t b = 0; b < 3; b++)
        map.runs[b].last_layer_dim = 0;
    assert_refused(&config);
    for (uint32_t b = 0; b < 3; b++)
        map.runs[b].last_layer_dim = VDNA_TRUST_CODES_MAX + 1;
    assert_refused(&config);
}

static void the_block_may_not_be_a_byte_too_small(void **state)
{
    (void)state;
    make_map(3);
    make_likeness(0.1);
    make_trust(3, 0);
    const vdna_select_config config = config_of(3, 5);
    const size_t size = vdna_select_mem_size(&config);
    vdna_select *select;
    assert_int_equal(vdna_select_init(&config, block, size - 1, &select), VDNA_ERR_NOMEM);
    OK(vdna_select_init(&config, block, size, &select));
}

static void a_selector_that_is_not_there_trusts_nothing(void **state)
{
    (void)state;
    uint32_t count = 7;
    assert_null(vdna_select_trust(NULL));
    assert_null(vdna_select_predictions(NULL, &count));
    assert_int_equal(count, 0);
    assert_int_equal(vdna_select_ranked_by(NULL), VDNA_SELECT_BY_EMD);
    assert_int_equal(vdna_select_switches(NULL), 0);
    assert_int_equal(vdna_select_previous(NULL), 0);
    assert_int_equal(vdna_select_feed_seen(NULL, NULL, NULL, NULL), VDNA_ERR_ARG);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_live_run_unlike_all_gets_the_least_bad_and_is_told),
        cmocka_unit_test(once_it_becomes_alike_another_choice_is_made),
        cmocka_unit_test(a_choice_that_promises_too_little_does_not_fit),
        cmocka_unit_test(time_that_steps_back_begins_the_next_warmup_anew_and_leaves_the_choice),
        cmocka_unit_test(a_frame_that_ends_a_warmup_by_time_is_not_in_it_and_begins_no_other),
        cmocka_unit_test(a_reset_forgets_that_none_fits),
        cmocka_unit_test(a_next_warmup_that_cannot_be_counted_begins_all_anew),
        cmocka_unit_test(a_choice_that_has_settled_comes_early_and_is_that_of_the_whole_warmup),
        cmocka_unit_test(an_early_choice_by_transfer_waits_for_twenty_frames),
        cmocka_unit_test(an_early_choice_is_in_the_order_of_the_scores),
        cmocka_unit_test(nothing_stops_early_where_distances_say_nothing),
        cmocka_unit_test(none_stops_early_without_trust),
        cmocka_unit_test(a_choice_that_settles_with_the_last_frame_is_not_early),
        cmocka_unit_test(while_none_fits_every_warmup_is_whole),
        cmocka_unit_test(a_ranking_by_transfer_puts_first_who_did_well_for_the_like),
        cmocka_unit_test(of_the_same_transfer_the_nearer_is_first_and_only_the_same_distance_ties),
        cmocka_unit_test(the_first_by_transfer_has_its_distance_though_others_are_nearer),
        cmocka_unit_test(a_bound_ties_with_nothing),
        cmocka_unit_test(without_labels_the_distance_ranks),
        cmocka_unit_test(trust_does_not_change_what_distance_ranks),
        cmocka_unit_test(the_last_layer_judges_if_all_runs_have_it),
        cmocka_unit_test(a_map_that_cannot_be_measured_refuses_the_frame_whole),
        cmocka_unit_test(a_config_that_does_not_go_together_is_refused),
        cmocka_unit_test(runs_that_are_not_those_of_the_candidates_are_refused),
        cmocka_unit_test(runs_need_the_last_layer_that_trust_judges_by),
        cmocka_unit_test(the_block_may_not_be_a_byte_too_small),
        cmocka_unit_test(a_selector_that_is_not_there_trusts_nothing),
    };
    return cmocka_run_group_tests_name("select_trust", tests, NULL, NULL);
}
