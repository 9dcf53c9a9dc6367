#include <string.h>

#include "select_state.h"

/* see select_state.h */
void vdna_select_forget(vdna_select *select)
{
    const vdna_select_config *config = &select->config;
    for (uint32_t i = 0; config->localisers && i < config->candidate_count; i++)
        vdna_localise_reset(config->localisers[i]);
    select->lead_count = 0;
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
            vdna_localise_warm_up(config->localisers[i], place);
    memcpy(place, embedding, config->dim * sizeof *embedding);
    select->lead_count++;
}

/* ---- Following ---- */

/* How many of the ranking are localised in at each frame. All of them while others may be chosen at
 * any frame: those know then where the robot is. */
static uint32_t followed(const vdna_select *select)
{
    const vdna_select_config *config = &select->config;
    if (config->reselect || select->state == VDNA_SELECT_NONE_FITS)
        return config->candidate_count;
    return config->top < config->candidate_count ? config->top : config->candidate_count;
}

/* Localisers refuse nothing: the embedding was checked, and they have its size. */
static void follow(vdna_select *select, const float *embedding)
{
    const uint32_t count = followed(select);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t candidate = select->ranking[i].candidate;
        vdna_localise_feed(select->config.localisers[candidate], embedding,
                           &select->answers[candidate]);
    }
}

/* Believe the most confident of the first of the ranking. */
static void believe(vdna_select *select)
{
    const vdna_select_config *config = &select->config;
    vdna_select_position *const best = &select->position;
    for (uint32_t i = 0; i < config->top && i < config->candidate_count; i++) {
        const uint32_t candidate = select->ranking[i].candidate;
        const vdna_localise_answer *answer = &select->answers[candidate];
        if (i > 0 && answer->confidence <= best->answer.confidence)
            continue;
        best->candidate = candidate;
        best->answer = *answer;
    }
}

/* see select_state.h */
void vdna_select_follow_leads(vdna_select *select)
{
    if (!select->config.localisers)
        return;
    uint64_t number = 0;
    if (select->lead_count > VDNA_LOCALISE_LEAD_FRAMES)
        number = select->lead_count - VDNA_LOCALISE_LEAD_FRAMES;
    for (; number < select->lead_count; number++)
        follow(select, lead(select, number));
    believe(select);
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
    select->previous = select->chosen;
    select->chosen = choice;
    select->switches++;
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
    uint32_t choice = select->chosen;
    vdna_trust_suit(trust, suits, confidence, suits);
    vdna_trust_reconsider(trust, suits, RECONSIDER_FRAMES, &choice);
    if (choice != select->chosen)
        switch_choice(select, choice);
}

/* ---- Localising ---- */

static vdna_status find_nearest_frame(const vdna_select *select, const float *embedding,
                                      vdna_knn_match *match)
{
    const vdna_select_candidate *chosen = &select->config.candidates[select->chosen];
    return vdna_knn(embedding, select->config.dim, chosen->embeddings, chosen->frames, 1, match);
}

/* see select_state.h */
vdna_status vdna_select_localise(vdna_select *select, const float *embedding,
                                 vdna_select_answer *answer)
{
    if (!select->config.localisers) {
        const vdna_status status = find_nearest_frame(select, embedding, &answer->match);
        answer->localised = status == VDNA_OK;
        return status;
    }
    follow(select, embedding);
    if (select->config.reselect && select->state == VDNA_SELECT_SELECTED)
        reconsider(select, embedding);
    believe(select);
    answer->match.index = select->position.answer.nearest;
    answer->match.distance_sq = 2 * select->position.answer.nearest_distance;
    answer->localised = 1;
    return VDNA_OK;
}
