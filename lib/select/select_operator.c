#include "select_state.h"

/* see select_state.h */
uint32_t vdna_select_held(const vdna_select *select)
{
    return select->pinned != VDNA_SELECT_NONE ? select->pinned : select->kept;
}

/* see select_state.h */
void vdna_select_decide(vdna_select *select)
{
    const uint32_t held = vdna_select_held(select);
    const int is_ranked = select->state != VDNA_SELECT_WARMUP;
    select->chosen = is_ranked ? select->ranking[0].candidate : 0;
    if (held != VDNA_SELECT_NONE)
        select->chosen = held;
    if (select->shadow && (is_ranked || held != VDNA_SELECT_NONE))
        select->kept = select->chosen;
}

/* see select_state.h */
void vdna_select_put_excluded_last(vdna_select *select)
{
    vdna_rank_entry *const ranking = select->ranking;
    for (uint32_t i = 1; i < select->config.candidate_count; i++) {
        const vdna_rank_entry entry = ranking[i];
        uint32_t at = i;
        for (; !select->excluded[entry.candidate] && at > 0 &&
               select->excluded[ranking[at - 1].candidate];
             at--)
            ranking[at] = ranking[at - 1];
        ranking[at] = entry;
    }
}

/* The verdict on a choice that follows from a command. If another warmup has begun, its end
 * brings one. */
static void judge_choice(vdna_select *select)
{
    if (!select->is_over)
        return;
    vdna_trust_judge(select->config.trust, select->chosen, select->predictions, &select->trusted);
    select->state =
        select->trusted.verdict == VDNA_TRUST_FITS ? VDNA_SELECT_SELECTED : VDNA_SELECT_NONE_FITS;
}

/* Localise from now on in what is held, or in the choice.
 * @param before  what was held before */
static void hold(vdna_select *select, uint32_t before)
{
    const uint32_t held = vdna_select_held(select), chosen = select->chosen;
    /* The localiser of what was held knows frames that the leads would bring again. */
    if (select->state == VDNA_SELECT_WARMUP && held != before) {
        if (before == VDNA_SELECT_NONE)
            vdna_select_take_up(select, held);
        else
            vdna_select_warm_up_again(select);
    }
    vdna_select_decide(select);
    if (select->chosen != chosen)
        judge_choice(select);
}

/* see vdna/select.h */
vdna_status vdna_select_pin(vdna_select *select, uint32_t candidate)
{
    if (!select)
        return VDNA_ERR_ARG;
    if (candidate != VDNA_SELECT_NONE &&
        (candidate >= select->config.candidate_count || select->excluded[candidate]))
        return VDNA_ERR_ARG;
    vdna_select_catch_up(select);
    const uint32_t before = vdna_select_held(select);
    select->pinned = candidate;
    hold(select, before);
    return VDNA_OK;
}

/* see vdna/select.h */
uint32_t vdna_select_pinned(const vdna_select *select)
{
    return select ? select->pinned : VDNA_SELECT_NONE;
}

/* see vdna/select.h */
vdna_status vdna_select_shadow(vdna_select *select, uint32_t on)
{
    if (!select || on > 1)
        return VDNA_ERR_ARG;
    vdna_select_catch_up(select);
    const uint32_t before = vdna_select_held(select);
    select->shadow = on;
    if (!on)
        select->kept = VDNA_SELECT_NONE;
    hold(select, before);
    return VDNA_OK;
}

/* see vdna/select.h */
uint32_t vdna_select_in_shadow(const vdna_select *select)
{
    return select ? select->shadow : 0;
}

static int is_last_allowed(const vdna_select *select, uint32_t candidate)
{
    uint32_t others = 0;
    for (uint32_t i = 0; i < select->config.candidate_count; i++)
        others += i != candidate ? !select->excluded[i] : 0u;
    return others == 0;
}

/* The ranking without what is excluded, and the choice that follows. */
static void choose_among_rest(vdna_select *select)
{
    const uint32_t first = select->ranking[0].candidate, chosen = select->chosen;
    vdna_select_put_excluded_last(select);
    vdna_select_decide(select);
    if (select->config.reselect && select->ranking[0].candidate != first)
        vdna_trust_choose(select->config.trust, select->ranking[0].candidate);
    if (select->chosen != chosen)
        judge_choice(select);
}

/* see vdna/select.h */
vdna_status vdna_select_exclude(vdna_select *select, uint32_t candidate, uint32_t on)
{
    if (!select || candidate >= select->config.candidate_count || on > 1)
        return VDNA_ERR_ARG;
    if (on && (candidate == select->pinned || is_last_allowed(select, candidate)))
        return VDNA_ERR_ARG;
    if (select->excluded[candidate] == on)
        return VDNA_OK;
    vdna_select_catch_up(select);
    select->excluded[candidate] = (uint8_t)on;
    if (select->kept == candidate)
        select->kept = VDNA_SELECT_NONE;
    /* Trust has measured the frames of this warmup for other candidates. */
    if (!select->is_over)
        vdna_select_warm_up_again(select);
    if (select->state != VDNA_SELECT_WARMUP)
        choose_among_rest(select);
    return VDNA_OK;
}

/* see vdna/select.h */
uint32_t vdna_select_is_excluded(const vdna_select *select, uint32_t candidate)
{
    return select && candidate < select->config.candidate_count ? select->excluded[candidate] : 0;
}
