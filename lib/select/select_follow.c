#include <string.h>

#include "select_state.h"

/* see select_state.h */
void vdna_select_forget(vdna_select *select)
{
    const vdna_select_config *config = &select->config;
    const uint32_t held = vdna_select_held(select);
    for (uint32_t i = 0; config->localisers && i < config->candidate_count; i++)
        if (i != held)
            vdna_localise_reset(config->localisers[i]);
    select->lead_count = 0;
    select->is_behind = 0;
}

/* see select_state.h */
void vdna_select_forget_held(vdna_select *select)
{
    const uint32_t held = vdna_select_held(select);
    if (select->config.localisers && held != VDNA_SELECT_NONE)
        vdna_localise_reset(select->config.localisers[held]);
}

/* ---- Leads ---- */

static float *lead(const vdna_select *select, uint64_t number)
{
    return select->leads + select->config.dim * (number % VDNA_LOCALISE_LEAD_FRAMES);
}

/* see select_state.h */
void vdna_select_take_lead(vdna_select *select, const float *embedding)
{
    const vdna_select_config *config = &select->config;
    if (!config->localisers)
        return;
    float *const place = lead(select, select->lead_count);
    if (select->lead_count >= VDNA_LOCALISE_LEAD_FRAMES)
        for (uint32_t i = 0; i < config->candidate_count; i++)
            if (i != vdna_select_held(select))
                vdna_localise_warm_up(config->localisers[i], place);
    memcpy(place, embedding, config->dim * sizeof *embedding);
    select->lead_count++;
}

/* ---- Following ---- */

/* How many of the ranking are localised in at each frame. All of them while others may be chosen at
 * any frame: those know then where the robot is. 0 = in the choice alone, which is held. */
static uint32_t followed(const vdna_select *select)
{
    const vdna_select_config *config = &select->config;
    if (config->reselect || select->state == VDNA_SELECT_NONE_FITS)
        return config->candidate_count;
    if (vdna_select_held(select) != VDNA_SELECT_NONE)
        return 0;
    return config->top < config->candidate_count ? config->top : config->candidate_count;
}

/* Localisers refuse nothing: the embedding was checked, and they have its size. */
static void follow_in(vdna_select *select, uint32_t candidate, const float *embedding)
{
    vdna_localise_feed(select->config.localisers[candidate], embedding,
                       &select->answers[candidate]);
}

/* Follow in all that are followed. */
static void follow(vdna_select *select, const float *embedding)
{
    const uint32_t count = followed(select);
    for (uint32_t i = 0; i < count; i++)
        follow_in(select, select->ranking[i].candidate, embedding);
    if (count == 0)
        follow_in(select, select->chosen, embedding);
}

/* Believe what is held, or the most confident of the first of the ranking that may be chosen. */
static void believe(vdna_select *select)
{
    const vdna_select_config *config = &select->config;
    vdna_select_position *const best = &select->position;
    best->candidate = select->chosen;
    best->answer = select->answers[select->chosen];
    select->is_placed = 1;
    if (vdna_select_held(select) != VDNA_SELECT_NONE)
        return;
    for (uint32_t i = 1; i < config->top && i < config->candidate_count; i++) {
        const uint32_t candidate = select->ranking[i].candidate;
        const vdna_localise_answer *answer = &select->answers[candidate];
        if (select->excluded[candidate] || answer->confidence <= best->answer.confidence)
            continue;
        best->candidate = candidate;
        best->answer = *answer;
    }
}

/* Its number. */
static uint64_t oldest_lead(const vdna_select *select)
{
    return select->lead_count > VDNA_LOCALISE_LEAD_FRAMES
               ? select->lead_count - VDNA_LOCALISE_LEAD_FRAMES
               : 0;
}

/* see select_state.h */
void vdna_select_take_up(vdna_select *select, uint32_t candidate)
{
    for (uint64_t number = oldest_lead(select); number < select->lead_count; number++)
        follow_in(select, candidate, lead(select, number));
}

/* Let some of the ranking follow the leads, from one place to before another. */
static void take_up_places(vdna_select *select, uint32_t from, uint32_t to, uint32_t but)
{
    for (uint32_t i = from; i < to; i++)
        if (select->ranking[i].candidate != but)
            vdna_select_take_up(select, select->ranking[i].candidate);
}

/* see select_state.h; whatever is followed behind the first `top` has no say in the answer. */
void vdna_select_follow_leads(vdna_select *select, uint32_t held)
{
    const vdna_select_config *config = &select->config;
    if (!config->localisers)
        return;
    const uint32_t count = followed(select);
    take_up_places(select, 0, count < config->top ? count : config->top, held);
    if (count == 0 && select->chosen != held)
        vdna_select_take_up(select, select->chosen);
    if (held == VDNA_SELECT_NONE)
        believe(select);
    select->is_behind = 1;
}

/* see vdna/select.h; what is held is one of the first, or has followed since before the choice. */
void vdna_select_catch_up(vdna_select *select)
{
    if (!select || !select->is_behind)
        return;
    take_up_places(select, select->config.top, followed(select), vdna_select_held(select));
    select->is_behind = 0;
}

/* ---- Choosing again ---- */

/* Of a robot that moves, the choice is reconsidered at every so many frames. More often, it takes
 * more time and chooses no better. */
#define RECONSIDER_FRAMES 5u

/* Bring the new choice to the front of the ranking; the others keep their order. */
static void switch_choice(vdna_select *select, uint32_t choice)
{
    vdna_rank_entry *const ranking = select->ranking;
    uint32_t at = 0;
    while (ranking[at].candidate != choice)
        at++;
    const vdna_rank_entry chosen = ranking[at];
    for (; at > 0; at--)
        ranking[at] = ranking[at - 1];
    ranking[0] = chosen;
    select->previous = ranking[1].candidate;
    select->switches++;
    vdna_select_decide(select);
}

/* Compare how the candidates suit a frame. One that cannot be measured says nothing. */
static void reconsider(vdna_select *select, const float *embedding)
{
    vdna_trust *const trust = select->config.trust;
    double *const suits = select->of_candidates, *const confidence = select->likeness;
    if (!select->answers[select->chosen].moving || ++select->moved % RECONSIDER_FRAMES != 0 ||
        vdna_select_measure(select, embedding) != VDNA_OK)
        return;
    for (uint32_t i = 0; i < select->config.candidate_count; i++)
        confidence[i] = select->answers[i].confidence;
    uint32_t choice = select->ranking[0].candidate;
    vdna_trust_suit(trust, suits, confidence, suits);
    for (uint32_t i = 0; i < select->config.candidate_count; i++)
        suits[i] = select->excluded[i] ? 0 : suits[i];
    vdna_trust_reconsider(trust, suits, RECONSIDER_FRAMES, &choice);
    if (choice != select->ranking[0].candidate)
        switch_choice(select, choice);
}

/* ---- Localising ---- */

static vdna_status find_nearest_frame(const vdna_select *select, const float *embedding,
                                      vdna_knn_match *match)
{
    const vdna_select_candidate *chosen = &select->config.candidates[select->chosen];
    return vdna_knn(embedding, select->config.dim, chosen->embeddings, chosen->frames, 1, match);
}

/* Answer with where the robot is believed to be. */
static void place(vdna_select *select, vdna_select_answer *answer)
{
    believe(select);
    answer->match.index = select->position.answer.nearest;
    answer->match.distance_sq = 2 * select->position.answer.nearest_distance;
    answer->localised = 1;
}

static vdna_status place_nearest_frame(const vdna_select *select, const float *embedding,
                                       vdna_select_answer *answer)
{
    const vdna_status status = find_nearest_frame(select, embedding, &answer->match);
    answer->localised = status == VDNA_OK;
    return status;
}

/* see select_state.h */
vdna_status vdna_select_localise(vdna_select *select, const float *embedding,
                                 vdna_select_answer *answer)
{
    if (!select->config.localisers)
        return place_nearest_frame(select, embedding, answer);
    vdna_select_catch_up(select);
    follow(select, embedding);
    if (select->config.reselect && select->state == VDNA_SELECT_SELECTED)
        reconsider(select, embedding);
    place(select, answer);
    return VDNA_OK;
}

/* see select_state.h */
void vdna_select_localise_in_held(vdna_select *select, uint32_t held, const float *embedding,
                                  vdna_select_answer *answer)
{
    if (held == VDNA_SELECT_NONE)
        return;
    if (!select->config.localisers) {
        place_nearest_frame(select, embedding, answer);
        return;
    }
    follow_in(select, held, embedding);
    place(select, answer);
}
