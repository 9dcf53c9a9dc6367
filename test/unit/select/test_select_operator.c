/* What an operator tells a selector: to localise in one experience, never to choose another, or
 * only to recommend. */
#include "lights.h"

enum { WARMUP = 12 };

static vdna_select *driven_by_day(uint32_t frames, uint32_t reselect, uint32_t *out_time)
{
    make_map();
    vdna_select *select = selector(make_trust(NULL), WARMUP, reselect);
    for (*out_time = 0; *out_time < frames; ++*out_time)
        drive(select, *out_time, DAY);
    return select;
}

static void assert_order(const vdna_select *select, uint32_t first, uint32_t second, uint32_t third)
{
    const vdna_rank_entry *ranking = vdna_select_ranking(select, NULL);
    assert_int_equal(ranking[0].candidate, first);
    assert_int_equal(ranking[1].candidate, second);
    assert_int_equal(ranking[2].candidate, third);
}

/* ---- Pinned ---- */

static void the_pinned_is_localised_in_at_once_and_the_ranking_stays(void **state)
{
    (void)state;
    uint32_t t;
    vdna_select *select = driven_by_day(20, 0, &t);
    OK(vdna_select_pin(select, NIGHT));
    assert_int_equal(vdna_select_pinned(select), NIGHT);
    assert_int_equal(vdna_select_chosen(select), NIGHT);
    assert_order(select, DAY, FOG, NIGHT);
    for (uint32_t end = t + 30; t < end; t++) {
        assert_int_equal(drive(select, t, NIGHT).localised, 1);
        assert_int_equal(vdna_select_where(select)->candidate, NIGHT);
    }
    assert_int_equal(vdna_select_where(select)->answer.frame, (t - 1) % FRAMES);
    OK(vdna_select_pin(select, VDNA_SELECT_NONE));
    assert_int_equal(vdna_select_pinned(select), VDNA_SELECT_NONE);
    assert_int_equal(vdna_select_chosen(select), DAY);
    drive(select, t, DAY);
    assert_int_equal(vdna_select_where(select)->candidate, DAY);
}

static void what_is_pinned_from_the_start_is_localised_in_while_warming_up(void **state)
{
    (void)state;
    for (uint32_t reselect = 0; reselect < 2; reselect++) {
        make_map();
        vdna_select *select = selector(make_trust(NULL), WARMUP, reselect);
        assert_int_equal(vdna_select_has_choice(select), 0);
        OK(vdna_select_pin(select, NIGHT));
        assert_int_equal(vdna_select_has_choice(select), 1);
        assert_null(vdna_select_where(select)); /* before the first frame */
        for (uint32_t t = 0; t < 20; t++) {
            const vdna_select_answer answer = drive(select, t, NIGHT);
            assert_int_equal(answer.localised, 1);
            assert_int_equal(answer.newly_ranked, t == WARMUP - 1);
            assert_int_equal(vdna_select_where(select)->candidate, NIGHT);
        }
        assert_int_equal(vdna_select_where(select)->answer.frame, 19);
        assert_int_equal(vdna_select_chosen(select), NIGHT);
        assert_order(select, DAY, FOG, NIGHT); /* by the histogram, which is that of the day */
    }
}

/* Its localiser has seen each frame once: as one that was fed these frames alone. */
static void pinned_in_the_middle_of_a_warmup_it_takes_up_the_frames_so_far(void **state)
{
    (void)state;
    for (uint32_t frames = 5; frames < 15; frames += 9) { /* fewer than lead, and all that lead */
        make_map();
        vdna_select *select = selector(make_trust(NULL), 20, 0);
        uint32_t t = 0;
        for (; t < frames; t++)
            assert_int_equal(drive(select, t, DAY).localised, 0);
        OK(vdna_select_pin(select, DAY));
        for (; t < 24; t++)
            assert_int_equal(drive(select, t, DAY).localised, 1);
        const double found = vdna_localise_mean(localisers[DAY])[0];
        assert_int_equal(vdna_select_where(select)->answer.frame, 23);

        make_map();
        const uint32_t lead = VDNA_LOCALISE_LEAD_FRAMES, warm = frames > lead ? frames - lead : 0;
        for (t = 0; t < 24; t++) {
            float embedding[DIM];
            vdna_localise_answer answer;
            see(t, DAY, embedding);
            OK(t < warm ? vdna_localise_warm_up(localisers[DAY], embedding)
                        : vdna_localise_feed(localisers[DAY], embedding, &answer));
        }
        assert_true(found == vdna_localise_mean(localisers[DAY])[0]);
    }
}

static void a_pin_outlasts_resets_and_forgets_the_place(void **state)
{
    (void)state;
    uint32_t t;
    vdna_select *select = driven_by_day(20, 0, &t);
    OK(vdna_select_pin(select, NIGHT));
    drive(select, t++, NIGHT);
    vdna_select_reset(select);
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_WARMUP);
    assert_int_equal(vdna_select_chosen(select), NIGHT);
    assert_null(vdna_select_where(select));
    assert_true(vdna_localise_evidence(localisers[NIGHT]) == 0);
    assert_int_equal(drive(select, t, NIGHT).localised, 1);
}

static void another_pin_while_warming_up_begins_the_warmup_anew(void **state)
{
    (void)state;
    make_map();
    vdna_select *select = selector(make_trust(NULL), WARMUP, 0);
    OK(vdna_select_pin(select, NIGHT));
    drive(select, 0, DAY);
    OK(vdna_select_pin(select, NIGHT)); /* as it is */
    assert_int_equal(vdna_select_window_frames(select), 1);
    OK(vdna_select_pin(select, DAY));
    assert_int_equal(vdna_select_window_frames(select), 0);
    assert_int_equal(vdna_select_chosen(select), DAY);
    drive(select, 1, DAY);
    assert_int_equal(vdna_select_where(select)->candidate, DAY);
    OK(vdna_select_pin(select, VDNA_SELECT_NONE));
    assert_int_equal(vdna_select_has_choice(select), 0);
    assert_null(vdna_select_where(select));
    assert_int_equal(drive(select, 2, DAY).localised, 0);
}

static void the_verdict_is_on_the_pinned(void **state)
{
    (void)state;
    make_map();
    vdna_select *select = selector(make_trust(lonely_tables()), WARMUP, 0);
    uint32_t t = 0;
    for (; t < WARMUP; t++)
        drive(select, t, DAY);
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_SELECTED);
    OK(vdna_select_pin(select, NIGHT));
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_NONE_FITS);
    assert_int_equal(vdna_select_trust(select)->verdict, VDNA_TRUST_UNLIKE);
    drive(select, t++, DAY);          /* begins another warmup */
    OK(vdna_select_pin(select, DAY)); /* of too few frames nothing is said */
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_NONE_FITS);
    for (; t < 2 * WARMUP; t++)
        drive(select, t, DAY);
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_SELECTED);
    OK(vdna_select_pin(select, NIGHT));
    for (uint32_t end = t + WARMUP; t < end; t++)
        drive(select, t, DAY);
    drive(select, t++, DAY); /* begins another one; the pinned goes on following */
    assert_int_equal(vdna_select_window_frames(select), 1);
    assert_true(vdna_localise_evidence(localisers[NIGHT]) != 0);
    for (uint32_t end = t + WARMUP - 1; t < end; t++) /* judged again */
        drive(select, t, DAY);
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_NONE_FITS);
    OK(vdna_select_pin(select, VDNA_SELECT_NONE));
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_SELECTED);
    assert_int_equal(vdna_select_chosen(select), DAY);
}

/* ---- Excluded ---- */

static void the_excluded_choice_gives_way_to_the_first_of_the_rest(void **state)
{
    (void)state;
    uint32_t t;
    vdna_select *select = driven_by_day(20, 0, &t);
    OK(vdna_select_exclude(select, DAY, 1));
    assert_int_equal(vdna_select_is_excluded(select, DAY), 1);
    assert_int_equal(vdna_select_chosen(select), FOG);
    assert_order(select, FOG, NIGHT, DAY);
    drive(select, t++, DAY);
    assert_int_equal(vdna_select_where(select)->candidate, FOG);
    OK(vdna_select_exclude(select, DAY, 0)); /* for the next choice */
    assert_int_equal(vdna_select_chosen(select), FOG);
    vdna_select_reset(select);
    for (uint32_t end = t + WARMUP; t < end; t++)
        drive(select, t, DAY);
    assert_int_equal(vdna_select_chosen(select), DAY);
}

static void excluding_outlasts_resets_and_begins_a_warmup_anew(void **state)
{
    (void)state;
    uint32_t t;
    vdna_select *select = driven_by_day(5, 0, &t);
    OK(vdna_select_exclude(select, DAY, 1));
    assert_int_equal(vdna_select_window_frames(select), 0);
    drive(select, t++, DAY);
    OK(vdna_select_exclude(select, DAY, 1)); /* as it is */
    assert_int_equal(vdna_select_window_frames(select), 1);
    vdna_select_reset(select);
    for (uint32_t end = t + WARMUP; t < end; t++)
        drive(select, t, DAY);
    assert_int_equal(vdna_select_chosen(select), FOG);
    assert_order(select, FOG, NIGHT, DAY);
    OK(vdna_select_exclude(select, NIGHT, 1));
    assert_order(select, FOG, NIGHT, DAY);
}

/* Night alone looks like this run, and none of the rest does. */
static void what_is_excluded_does_not_make_a_run_fit(void **state)
{
    (void)state;
    make_map();
    vdna_select *select = selector(make_trust(lonely_tables()), WARMUP, 0);
    OK(vdna_select_exclude(select, NIGHT, 1));
    uint32_t t = 0;
    for (; t < WARMUP; t++)
        drive(select, t, NIGHT);
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_NONE_FITS);
    drive(select, t++, NIGHT);
    OK(vdna_select_exclude(select, NIGHT,
                           0)); /* begins the next warmup anew, and keeps the choice */
    assert_int_equal(vdna_select_window_frames(select), 0);
    assert_int_equal(vdna_select_chosen(select), DAY);
    for (uint32_t end = t + WARMUP; t < end; t++)
        drive(select, t, NIGHT);
    assert_int_equal(vdna_select_state(select), VDNA_SELECT_SELECTED);
}

static void no_switch_goes_to_what_is_excluded(void **state)
{
    (void)state;
    uint32_t t;
    vdna_select *select = driven_by_day(60, 1, &t);
    OK(vdna_select_exclude(select, NIGHT, 1));
    for (; t < 160; t++) {
        drive(select, t, NIGHT);
        assert_int_not_equal(vdna_select_chosen(select), NIGHT);
    }
    OK(vdna_select_exclude(select, NIGHT, 0));
    for (; vdna_select_chosen(select) != NIGHT; t++) {
        assert_true(t < 260);
        drive(select, t, NIGHT);
    }
}

/* The choice that is watched is the one that the exclusion made. */
static void the_choice_after_an_exclusion_is_reconsidered_in_turn(void **state)
{
    (void)state;
    uint32_t t;
    vdna_select *select = driven_by_day(60, 1, &t);
    OK(vdna_select_exclude(select, DAY, 1));
    assert_int_equal(vdna_select_chosen(select), FOG);
    for (; vdna_select_switches(select) == 0; t++) {
        assert_true(t < 160);
        drive(select, t, NIGHT);
    }
    assert_int_equal(vdna_select_chosen(select), NIGHT);
    assert_int_equal(vdna_select_previous(select), FOG);
}

static void the_pinned_and_the_last_one_are_not_excluded(void **state)
{
    (void)state;
    uint32_t t;
    vdna_select *select = driven_by_day(20, 0, &t);
    OK(vdna_select_pin(select, FOG));
    assert_int_equal(vdna_select_exclude(select, FOG, 1), VDNA_ERR_ARG);
    OK(vdna_select_exclude(select, NIGHT, 1));
    assert_int_equal(vdna_select_pin(select, NIGHT), VDNA_ERR_ARG);
    OK(vdna_select_exclude(select, DAY, 1));
    OK(vdna_select_pin(select, VDNA_SELECT_NONE));
    assert_int_equal(vdna_select_chosen(select), FOG);
    assert_int_equal(vdna_select_exclude(select, FOG, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_select_is_excluded(select, FOG), 0);
}

/* ---- In shadow ---- */

static void in_shadow_switches_are_recommended_and_followed_afterwards(void **state)
{
    (void)state;
    uint32_t t;
    vdna_select *select = driven_by_day(60, 1, &t);
    OK(vdna_select_shadow(select, 1));
    assert_int_equal(vdna_select_in_shadow(select), 1);
    for (; vdna_select_switches(select) == 0; t++) {
        assert_true(t < 160);
        drive(select, t, NIGHT);
    }
    assert_int_equal(vdna_select_chosen(select), DAY);
    assert_int_equal(vdna_select_previous(select), DAY);
    assert_int_equal(vdna_select_ranking(select, NULL)[0].candidate, NIGHT);
    drive(select, t++, NIGHT);
    assert_int_equal(vdna_select_where(select)->candidate, DAY);
    OK(vdna_select_shadow(select, 0));
    assert_int_equal(vdna_select_chosen(select), NIGHT);
    drive(select, t, NIGHT);
    assert_int_equal(vdna_select_where(select)->candidate, NIGHT);
}

static void the_first_choice_in_shadow_is_kept_over_resets(void **state)
{
    (void)state;
    make_map();
    vdna_select *select = selector(make_trust(NULL), WARMUP, 0);
    OK(vdna_select_shadow(select, 1));
    uint32_t t = 0;
    for (; t < WARMUP; t++)
        assert_int_equal(drive(select, t, DAY).localised, 0);
    assert_int_equal(vdna_select_chosen(select), DAY);
    vdna_select_reset(select);
    OK(vdna_select_exclude(select, FOG, 1));
    for (uint32_t end = t + WARMUP; t < end; t++)
        assert_int_equal(drive(select, t, DAY).localised, 1);
    assert_int_equal(vdna_select_chosen(select), DAY);
    OK(vdna_select_exclude(select, DAY, 1)); /* what is left is kept instead */
    assert_int_equal(vdna_select_chosen(select), NIGHT);
    OK(vdna_select_exclude(select, DAY, 0));
    OK(vdna_select_exclude(select, FOG, 0));
    vdna_select_reset(select);
    for (uint32_t end = t + WARMUP; t < end; t++)
        drive(select, t, DAY);
    assert_int_equal(vdna_select_ranking(select, NULL)[0].candidate, DAY);
    assert_int_equal(vdna_select_chosen(select), NIGHT);
    vdna_select_reset(select);
    OK(vdna_select_shadow(select, 0)); /* nothing to go back to */
    assert_int_equal(vdna_select_has_choice(select), 0);
}

static void in_shadow_an_unpinned_one_is_kept(void **state)
{
    (void)state;
    uint32_t t;
    vdna_select *select = driven_by_day(20, 0, &t);
    OK(vdna_select_pin(select, NIGHT));
    OK(vdna_select_shadow(select, 1));
    OK(vdna_select_pin(select, VDNA_SELECT_NONE));
    assert_int_equal(vdna_select_chosen(select), NIGHT);
    OK(vdna_select_pin(select, FOG));
    OK(vdna_select_shadow(select, 0));
    assert_int_equal(vdna_select_chosen(select), FOG);
}

/* ---- Without localisers and trust; several at once; what is refused ---- */

static vdna_select *plain_selector(uint32_t top)
{
    make_map();
    for (uint32_t b = 0; b < RUNS; b++)
        candidates[b].embeddings = embeddings[b][0];
    vdna_select_config config;
    vdna_select_config_init(&config);
    config.candidates = candidates;
    config.candidate_count = RUNS;
    config.dim = DIM;
    config.warmup_frames = WARMUP;
    config.time_unit = VDNA_TIME_UNIT_US;
    config.localisers = top > 0 ? localisers : NULL;
    config.top = top > 0 ? top : 1;
    vdna_select *select;
    OK(vdna_select_init(&config, block, sizeof block, &select));
    return select;
}

static void without_localisers_the_pinned_has_the_nearest_frame(void **state)
{
    (void)state;
    vdna_select *select = plain_selector(0);
    OK(vdna_select_pin(select, NIGHT));
    for (uint32_t t = 0; t < 2 * WARMUP; t++) {
        const vdna_select_answer answer = drive(select, t, NIGHT);
        assert_int_equal(answer.localised, 1);
        assert_int_equal(answer.match.index, t);
        assert_null(vdna_select_where(select));
    }
    vdna_select_reset(select);
    assert_int_equal(drive(select, 30, NIGHT).match.index, 30);
    OK(vdna_select_pin(select, VDNA_SELECT_NONE));
    vdna_select_reset(select);
    assert_int_equal(drive(select, 31, NIGHT).localised, 0);
}

static void of_several_at_once_none_is_excluded(void **state)
{
    (void)state;
    vdna_select *select = plain_selector(RUNS + 1);
    uint32_t t = 0;
    for (; t < WARMUP + 20; t++)
        drive(select, t, NIGHT); /* the surest of all */
    assert_int_equal(vdna_select_chosen(select), DAY);
    assert_int_equal(vdna_select_where(select)->candidate, NIGHT);
    OK(vdna_select_exclude(select, NIGHT, 1));
    drive(select, t++, NIGHT);
    assert_int_not_equal(vdna_select_where(select)->candidate, NIGHT);
    OK(vdna_select_pin(select, FOG));
    drive(select, t, NIGHT);
    assert_int_equal(vdna_select_where(select)->candidate, FOG);
}

static void what_no_selector_can_do_is_refused(void **state)
{
    (void)state;
    uint32_t t;
    vdna_select *select = driven_by_day(20, 0, &t);
    assert_int_equal(vdna_select_pin(NULL, DAY), VDNA_ERR_ARG);
    assert_int_equal(vdna_select_pin(select, RUNS), VDNA_ERR_ARG);
    assert_int_equal(vdna_select_exclude(NULL, DAY, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_select_exclude(select, RUNS, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_select_exclude(select, DAY, 2), VDNA_ERR_ARG);
    assert_int_equal(vdna_select_shadow(NULL, 1), VDNA_ERR_ARG);
    assert_int_equal(vdna_select_shadow(select, 2), VDNA_ERR_ARG);
    assert_int_equal(vdna_select_pinned(NULL), VDNA_SELECT_NONE);
    assert_int_equal(vdna_select_pinned(select), VDNA_SELECT_NONE);
    assert_int_equal(vdna_select_is_excluded(NULL, DAY), 0);
    assert_int_equal(vdna_select_is_excluded(select, RUNS), 0);
    assert_int_equal(vdna_select_in_shadow(NULL), 0);
    assert_int_equal(vdna_select_in_shadow(select), 0);
    assert_int_equal(vdna_select_has_choice(NULL), 0);
    assert_int_equal(vdna_select_has_choice(select), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_pinned_is_localised_in_at_once_and_the_ranking_stays),
        cmocka_unit_test(what_is_pinned_from_the_start_is_localised_in_while_warming_up),
        cmocka_unit_test(pinned_in_the_middle_of_a_warmup_it_takes_up_the_frames_so_far),
        cmocka_unit_test(a_pin_outlasts_resets_and_forgets_the_place),
        cmocka_unit_test(another_pin_while_warming_up_begins_the_warmup_anew),
        cmocka_unit_test(the_verdict_is_on_the_pinned),
        cmocka_unit_test(the_excluded_choice_gives_way_to_the_first_of_the_rest),
        cmocka_unit_test(excluding_outlasts_resets_and_begins_a_warmup_anew),
        cmocka_unit_test(what_is_excluded_does_not_make_a_run_fit),
        cmocka_unit_test(no_switch_goes_to_what_is_excluded),
        cmocka_unit_test(the_choice_after_an_exclusion_is_reconsidered_in_turn),
        cmocka_unit_test(the_pinned_and_the_last_one_are_not_excluded),
        cmocka_unit_test(in_shadow_switches_are_recommended_and_followed_afterwards),
        cmocka_unit_test(the_first_choice_in_shadow_is_kept_over_resets),
        cmocka_unit_test(in_shadow_an_unpinned_one_is_kept),
        cmocka_unit_test(without_localisers_the_pinned_has_the_nearest_frame),
        cmocka_unit_test(of_several_at_once_none_is_excluded),
        cmocka_unit_test(what_no_selector_can_do_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
