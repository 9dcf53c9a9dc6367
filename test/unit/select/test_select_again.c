/* A selector with localisers that reconsiders its choice while driving, and one in which none fits:
 * whom it switches to, when, and what the localisers have seen by then. */
#include <string.h>

#include "lights.h"

static void a_constant_drive_sees_no_switch(void **state)
{
    (void)state;
    make_map();
    vdna_select *select = selector(make_trust(NULL), 12, 1);
    for (uint32_t t = 0; t < 300; t++)
        drive(select, t, DAY);
    assert_int_equal(vdna_select_chosen(select), DAY);
    assert_int_equal(vdna_select_switches(select), 0);
    assert_int_equal(vdna_select_previous(select), 0);
}

static void a_change_of_light_is_one_switch_and_the_new_choice_knows_the_place(void **state)
{
    (void)state;
    make_map();
    vdna_select *select = selector(make_trust(NULL), 12, 1);
    uint32_t t = 0;
    for (; t < 60; t++)
        drive(select, t, DAY);
    vdna_rank_entry before[RUNS];
    memcpy(before, vdna_select_ranking(select, NULL), sizeof before);
    assert_int_equal(before[2].candidate, NIGHT);
    assert_true(vdna_select_margin_bins(select) == 1);
    for (; vdna_select_switches(select) == 0; t++) {
        assert_true(t < 120);
        const vdna_select_answer answer = drive(select, t, NIGHT);
        assert_int_equal(answer.newly_ranked, 0);
        assert_int_equal(answer.state, VDNA_SELECT_SELECTED);
    }
    const vdna_select_position *where = vdna_select_where(select);
    assert_int_equal(vdna_select_chosen(select), NIGHT);
    assert_int_equal(where->candidate, NIGHT);
    assert_int_equal(where->answer.frame, (t - 1) % FRAMES);
    assert_true(where->answer.confidence > 0.5);

    const vdna_rank_entry *ranking = vdna_select_ranking(select, NULL);
    assert_memory_equal(&ranking[0], &before[2], sizeof *before);
    assert_memory_equal(&ranking[1], before, 2 * sizeof *before);
    assert_true(vdna_select_margin_bins(select) == -2);
    assert_int_equal(vdna_select_previous(select), DAY);
    for (uint32_t end = t + 200; t < end; t++)
        drive(select, t, NIGHT);
    assert_int_equal(vdna_select_switches(select), 1);

    vdna_select_reset(select); /* counters stay */
    assert_int_equal(vdna_select_switches(select), 1);
}

static void nothing_is_reconsidered_unless_told_to(void **state)
{
    (void)state;
    make_map();
    vdna_select *select = selector(make_trust(NULL), 12, 0);
    for (uint32_t t = 0; t < 60; t++)
        drive(select, t, DAY);
    for (uint32_t t = 60; t < 200; t++)
        drive(select, t, NIGHT);
    assert_int_equal(vdna_select_switches(select), 0);
    assert_true(vdna_localise_evidence(localisers[NIGHT]) == 0);
}

static void frames_of_a_standing_robot_or_beyond_measure_say_nothing(void **state)
{
    (void)state;
    make_map();
    vdna_select *select = selector(make_trust(NULL), 12, 1);
    uint32_t t = 0;
    for (; t < 60; t++)
        drive(select, t, DAY);
    float embedding[DIM];
    for (; t < 100; t++) {
        for (uint32_t i = 0; i < DIM && (t == 60 || t > 80); i++)
            embedding[i] = 3e38f * noise(); /* whose squared distance is beyond a float */
        feed(select, t, 0.5f, embedding);
    }
    assert_int_equal(vdna_select_switches(select), 0);
}

/* By day until 60, then by night as long as nobody switches, at most 100 frames.
 * @param step  frames of the route between two pictures
 * @return frames by night */
static uint32_t drive_into_the_night(vdna_select *select, uint32_t step)
{
    for (uint32_t t = 0; t < 60; t++)
        drive(select, t, DAY);
    float picture[DIM];
    see(20, NIGHT, picture);
    uint32_t t = 0;
    for (; t < 100 && vdna_select_switches(select) == 0; t++) {
        if (step > 0)
            see((20 + t * step) % FRAMES, NIGHT, picture);
        feed(select, 60 + t, 0.5f, picture);
    }
    return t;
}

static void a_standing_robot_keeps_its_choice(void **state)
{
    (void)state;
    make_map();
    assert_int_equal(drive_into_the_night(selector(make_trust(NULL), 12, 1), 0), 100);
    make_map();
    assert_true(drive_into_the_night(selector(make_trust(NULL), 12, 1), 1) < 60);
}

static void where_all_are_as_near_the_surer_place_decides(void **state)
{
    (void)state;
    make_map();
    for (uint32_t b = 0; b < RUNS; b++)
        runs[b].embeddings = embeddings[DAY][0];
    vdna_select *select = selector(make_trust(NULL), 12, 1);
    assert_true(drive_into_the_night(select, 1) < 100);
    assert_int_equal(vdna_select_chosen(select), NIGHT);
}

static void another_route_is_told_by_jumps_of_the_place(void **state)
{
    (void)state;
    make_map();
    vdna_select *select = selector(make_trust(NULL), 12, 0);
    for (uint32_t t = 0; t < 12; t++) {
        assert_int_equal(vdna_select_is_lost(select), 0);
        drive(select, t, DAY);
    }
    for (uint32_t t = 12; t < 80; t++) {
        drive(select, t, DAY);
        assert_int_equal(vdna_select_is_lost(select), 0);
    }
    for (uint32_t t = 80; t < 160; t++) /* every seventeenth frame */
        drive(select, t * (FRAMES + 17), DAY);
    assert_int_equal(vdna_select_is_lost(select), 1);
    assert_int_equal(vdna_select_is_lost(NULL), 0);
}

/* ---- Catching up ---- */

static void others_follow_the_warmup_after_the_choice(void **state)
{
    (void)state;
    make_map();
    vdna_select *select = selector(make_trust(NULL), 12, 1);
    for (uint32_t t = 0; t < 12; t++)
        drive(select, t, DAY);
    assert_true(vdna_localise_evidence(localisers[DAY]) != 0);
    assert_true(vdna_localise_evidence(localisers[NIGHT]) == 0);
    vdna_select_catch_up(select);
    const double led = vdna_localise_evidence(localisers[NIGHT]);
    assert_true(led != 0);
    vdna_select_catch_up(select);
    vdna_select_catch_up(NULL);
    assert_true(vdna_localise_evidence(localisers[NIGHT]) == led);
}

static void what_is_held_has_followed_since_before_the_choice(void **state)
{
    (void)state;
    make_map();
    vdna_select *select = selector(make_trust(NULL), 12, 1);
    OK(vdna_select_pin(select, NIGHT));
    for (uint32_t t = 0; t < 12; t++)
        drive(select, t, DAY);
    const double followed = vdna_localise_evidence(localisers[NIGHT]);
    assert_true(followed != 0);
    vdna_select_catch_up(select);
    assert_true(vdna_localise_evidence(localisers[NIGHT]) == followed);
    assert_true(vdna_localise_evidence(localisers[FOG]) != 0);
}

/* What an operator wants right after the choice of frame 11, or before and no more after it. */
enum { NOTHING, EXCLUDE_DAY, PIN_NIGHT, SHADOW, UNPIN_NIGHT, UNSHADOW_NIGHT, RESET, WISHES };

static void command_before(vdna_select *select, uint32_t wish)
{
    if (wish == UNPIN_NIGHT || wish == UNSHADOW_NIGHT)
        OK(vdna_select_pin(select, NIGHT));
    if (wish == UNSHADOW_NIGHT) { /* which goes on with what was pinned */
        OK(vdna_select_shadow(select, 1));
        OK(vdna_select_pin(select, VDNA_SELECT_NONE));
    }
}

static void command_after(vdna_select *select, uint32_t wish)
{
    if (wish == EXCLUDE_DAY)
        OK(vdna_select_exclude(select, DAY, 1));
    if (wish == PIN_NIGHT || wish == UNPIN_NIGHT)
        OK(vdna_select_pin(select, wish == PIN_NIGHT ? NIGHT : VDNA_SELECT_NONE));
    if (wish == SHADOW || wish == UNSHADOW_NIGHT)
        OK(vdna_select_shadow(select, wish == SHADOW));
    if (wish == RESET)
        vdna_select_reset(select);
}

/* By day, and from frame 60 on by night.
 * @param places  [120]
 * @param means   [RUNS][DIM], in the end */
static void drive_through_dusk(uint32_t wish, int catches_up, vdna_select_position *places,
                               double *means)
{
    make_map();
    vdna_select *select = selector(make_trust(NULL), 12, 1);
    command_before(select, wish);
    for (uint32_t t = 0; t < 120; t++) {
        drive(select, t, t < 60 ? DAY : NIGHT);
        if (catches_up)
            vdna_select_catch_up(select);
        if (t == 11)
            command_after(select, wish);
        if (t == 16 && wish == RESET)
            OK(vdna_select_pin(select, NIGHT));
        const vdna_select_position *where = vdna_select_where(select);
        memset(&places[t], 0, sizeof *places);
        if (where)
            places[t] = *where;
    }
    for (uint32_t b = 0; b < RUNS; b++)
        memcpy(means + (size_t)b * DIM, vdna_localise_mean(localisers[b]), DIM * sizeof *means);
}

static void no_answer_depends_on_catching_up(void **state)
{
    (void)state;
    for (uint32_t wish = 0; wish < WISHES; wish++) {
        static vdna_select_position places[2][120];
        static double means[2][RUNS * DIM];
        for (int catches_up = 0; catches_up < 2; catches_up++)
            drive_through_dusk(wish, catches_up, places[catches_up], means[catches_up]);
        assert_memory_equal(places[0], places[1], sizeof *places);
        assert_memory_equal(means[0], means[1], sizeof *means);
    }
}

/* ---- None fits ---- */

/* A frame that is unlike all. */
static vdna_select_answer drive_in_the_dark(vdna_select *select, uint32_t time)
{
    float embedding[DIM];
    for (uint32_t i = 0; i < DIM; i++)
        embedding[i] = 10 * noise();
    return feed(select, time, 3.5f, embedding);
}

static void while_none_fits_all_localisers_follow_so_the_next_choice_knows_the_place(void **state)
{
    (void)state;
    const uint32_t warmups[] = {5, 15}; /* fewer frames than lead, and more */
    for (uint32_t w = 0; w < 2; w++) {
        make_map();
        const uint32_t frames = warmups[w];
        vdna_select *select = selector(make_trust(lonely_tables()), frames, w);
        uint32_t t = 0;
        for (; t < frames; t++)
            drive_in_the_dark(select, t);
        assert_int_equal(vdna_select_state(select), VDNA_SELECT_NONE_FITS);
        assert_int_equal(vdna_select_chosen(select), NIGHT);
        assert_int_equal(vdna_select_where(select)->candidate, NIGHT);
        for (; t < 2 * frames - 1; t++)
            assert_int_equal(drive(select, t, DAY).localised, 1);
        assert_int_equal(vdna_select_where(select)->candidate, NIGHT);
        assert_int_equal(vdna_select_switches(select), 0);
        const vdna_select_answer answer = drive(select, t, DAY);
        assert_int_equal(answer.newly_ranked, 1);
        assert_int_equal(answer.state, VDNA_SELECT_SELECTED);
        assert_int_equal(answer.localised, 1);
        assert_int_equal(vdna_select_chosen(select), DAY);
        const vdna_select_position *where = vdna_select_where(select);
        assert_int_equal(where->candidate, DAY);
        assert_int_equal(where->answer.nearest, t % FRAMES);
        assert_int_equal(answer.match.index, t % FRAMES);
        assert_int_equal(where->answer.frame, t % FRAMES);
        drive(select, ++t, DAY);
        assert_int_equal(vdna_select_where(select)->answer.frame, t % FRAMES);
    }
}

/* Live means are those of localisers that were fed these frames and no others. */
static void every_localiser_sees_every_frame_of_the_newest_warmup_once(void **state)
{
    (void)state;
    make_map();
    vdna_select *select = selector(make_trust(lonely_tables()), 15, 0);
    for (uint32_t t = 0; t < 25; t++)
        drive_in_the_dark(select, t);
    double found[RUNS][DIM];
    for (uint32_t b = 0; b < RUNS; b++)
        memcpy(found[b], vdna_localise_mean(localisers[b]), sizeof found[b]);
    make_map(); /* and its randomness */
    for (uint32_t t = 0; t < 25; t++) {
        float embedding[DIM];
        for (uint32_t i = 0; i < DIM; i++)
            embedding[i] = 10 * noise();
        for (uint32_t b = 0; b < RUNS && t >= 15; b++)
            OK(vdna_localise_warm_up(localisers[b], embedding));
    }
    for (uint32_t b = 0; b < RUNS; b++)
        assert_memory_equal(found[b], vdna_localise_mean(localisers[b]), sizeof found[b]);
}

static void reconsidering_needs_trust_and_localisers(void **state)
{
    (void)state;
    make_map();
    vdna_select_config config;
    vdna_select_config_init(&config);
    config.candidates = candidates;
    config.candidate_count = RUNS;
    config.dim = DIM;
    config.warmup_frames = 5;
    config.localisers = localisers;
    assert_true(vdna_select_mem_size(&config) > 0);
    config.reselect = 1;
    assert_int_equal(vdna_select_mem_size(&config), 0);
    config.trust = make_trust(NULL);
    config.runs = runs;
    assert_true(vdna_select_mem_size(&config) > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_constant_drive_sees_no_switch),
        cmocka_unit_test(a_change_of_light_is_one_switch_and_the_new_choice_knows_the_place),
        cmocka_unit_test(frames_of_a_standing_robot_or_beyond_measure_say_nothing),
        cmocka_unit_test(a_standing_robot_keeps_its_choice),
        cmocka_unit_test(where_all_are_as_near_the_surer_place_decides),
        cmocka_unit_test(another_route_is_told_by_jumps_of_the_place),
        cmocka_unit_test(nothing_is_reconsidered_unless_told_to),
        cmocka_unit_test(others_follow_the_warmup_after_the_choice),
        cmocka_unit_test(what_is_held_has_followed_since_before_the_choice),
        cmocka_unit_test(no_answer_depends_on_catching_up),
        cmocka_unit_test(while_none_fits_all_localisers_follow_so_the_next_choice_knows_the_place),
        cmocka_unit_test(every_localiser_sees_every_frame_of_the_newest_warmup_once),
        cmocka_unit_test(reconsidering_needs_trust_and_localisers),
    };
    return cmocka_run_group_tests_name("select_again", tests, NULL, NULL);
}
