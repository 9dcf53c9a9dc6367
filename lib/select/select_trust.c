#include <math.h>

#include <vdna/int8.h>

#include "select_state.h"

static int is_by_likeness(const vdna_select_config *config)
{
    return config->trust && vdna_trust_fitted(config->trust)->by_likeness;
}

/* see select_state.h */
uint32_t vdna_select_codes(const vdna_select_config *config)
{
    return is_by_likeness(config) ? config->runs[0].last_layer_dim : 0;
}

/* ---- Configuration ---- */

static int has_codes(const vdna_trust_run *run, uint32_t dim)
{
    return run->last_layer && run->last_layer_scale && run->last_layer_dim == dim && dim > 0 &&
           dim <= VDNA_TRUST_CODES_MAX;
}

/* Whether frames can be measured in a candidate. */
static int can_measure_in(const vdna_select_config *config, uint32_t i)
{
    const vdna_trust_run *run = &config->runs[i];
    if (!run->embeddings || run->frames != config->candidates[i].frames || run->dim != config->dim)
        return 0;
    return !is_by_likeness(config) || has_codes(run, config->runs[0].last_layer_dim);
}

/* see select_state.h */
int vdna_select_may_trust(const vdna_select_config *config)
{
    if (config->rank > VDNA_SELECT_BY_TRANSFER || config->stop_early > 1 || config->reselect > 1)
        return 0;
    if (config->reselect && (!config->trust || !config->localisers))
        return 0;
    if (!config->trust)
        return 1;
    if (!config->runs || vdna_trust_runs(config->trust) != config->candidate_count)
        return 0;
    for (uint32_t i = 0; i < config->candidate_count; i++)
        if (!can_measure_in(config, i))
            return 0;
    return 1;
}

/* ---- Frames ---- */

/* see select_state.h */
vdna_status vdna_select_encode(vdna_select *select, const float *last_layer)
{
    const uint32_t count = vdna_select_codes(&select->config);
    return count == 0 ? VDNA_OK
                      : vdna_int8_encode(last_layer, count, select->codes, &select->code_scale);
}

/* see select_state.h */
vdna_status vdna_select_measure(vdna_select *select, const float *embedding)
{
    vdna_status status = VDNA_OK;
    const uint32_t count = select->config.trust ? select->config.candidate_count : 0;
    for (uint32_t i = 0; status == VDNA_OK && i < count; i++)
        status = vdna_trust_nearest_in(embedding, &select->config.runs[i],
                                       &select->of_candidates[i], NULL);
    return status;
}

static vdna_status measure_last_layer(vdna_select *select)
{
    vdna_status status = VDNA_OK;
    for (uint32_t i = 0; status == VDNA_OK && i < select->config.candidate_count; i++) {
        const vdna_trust_run *run = &select->config.runs[i];
        status = vdna_trust_nearest_int8(select->codes, select->code_scale, run->last_layer,
                                         run->last_layer_scale, run->last_layer_dim, run->frames,
                                         &select->likeness[i]);
    }
    return status;
}

/* see select_state.h */
vdna_status vdna_select_measure_for_warmup(vdna_select *select, const float *embedding)
{
    const vdna_status status = vdna_select_measure(select, embedding);
    return status == VDNA_OK && is_by_likeness(&select->config) ? measure_last_layer(select)
                                                                : status;
}

/* What is excluded is as far from a frame as anything can be, so that it never fits best. */
static const double farthest = 2;

/* see select_state.h */
void vdna_select_count(vdna_select *select)
{
    for (uint32_t i = 0; select->config.trust && i < select->config.candidate_count; i++)
        if (select->excluded[i])
            select->of_candidates[i] = select->likeness[i] = farthest;
    /* Nothing that was measured is refused, unless there are very many; then these are enough. */
    vdna_trust_feed(select->config.trust, select->of_candidates, select->likeness);
}

/* ---- The choice ---- */

/* Whether choices are in the order of transfer, which then all candidates have. */
static int is_by_transfer(const vdna_select_config *config)
{
    return config->rank == VDNA_SELECT_BY_TRANSFER &&
           vdna_trust_fitted(config->trust)->labelled == config->candidate_count;
}

/* Fewest frames of an early choice by transfer. With 20 its first is that of a whole warmup as
 * often as with 30, with 10 less often. */
#define TRANSFER_FRAMES_MIN 20u

/* see select_state.h; a later answer waits: the more often one asks whether none fits, the more
 * often the answer is wrong. */
int vdna_select_may_stop(const vdna_select *select)
{
    const vdna_select_config *config = &select->config;
    if (!config->stop_early || select->state != VDNA_SELECT_WARMUP ||
        vdna_trust_settled_frames(config->trust) == 0)
        return 0;
    return !is_by_transfer(config) || vdna_select_window_frames(select) >= TRANSFER_FRAMES_MIN;
}

/* By what a ranking is ordered, the highest first. */
static double merit_of(const vdna_select *select, const vdna_rank_entry *entry)
{
    const vdna_trust_prediction *of = &select->predictions[entry->candidate];
    return select->ranked_by == VDNA_SELECT_BY_RELATIVE ? of->score : of->transfer;
}

/* Order a ranking by merit; those of the same keep their order, which is that of the distances. */
static void order_by_merit(const vdna_select *select)
{
    vdna_rank_entry *const ranking = select->ranking;
    for (uint32_t i = 1; i < select->config.candidate_count; i++) {
        const vdna_rank_entry entry = ranking[i];
        const double merit = merit_of(select, &entry);
        uint32_t at = i;
        for (; at > 0 && merit > merit_of(select, &ranking[at - 1]); at--)
            ranking[at] = ranking[at - 1];
        ranking[at] = entry;
    }
}

/* The distances of the first places that have bounds, not counting what is excluded; what has a
 * bound has a distance. */
static void make_first_exact(const vdna_select *select)
{
    vdna_hist_view live;
    vdna_select_live(select, &live);
    const uint32_t count = select->sums ? select->config.candidate_count : 0;
    uint32_t places = select->config.exact;
    for (uint32_t i = 0; i < count && places > 0; i++) {
        vdna_rank_entry *const entry = &select->ranking[i];
        if (select->is_bound[entry->candidate])
            vdna_emd_mean(&live, &select->views[entry->candidate], select->scratch,
                          vdna_emd_scratch_size(live.neurons), &entry->distance_bins);
        select->is_bound[entry->candidate] = 0;
        places -= !select->excluded[entry->candidate];
    }
}

static int have_same_distance(const vdna_select *select, const vdna_rank_entry *a,
                              const vdna_rank_entry *b)
{
    if (select->is_bound[a->candidate] || select->is_bound[b->candidate])
        return 0;
    return a->distance_bins == b->distance_bins;
}

/* Mark those that only the order of the candidates tells apart. */
static void mark_ties(const vdna_select *select)
{
    vdna_rank_entry *const ranking = select->ranking;
    ranking[0].tied = 0;
    for (uint32_t i = 1; i < select->config.candidate_count; i++) {
        ranking[i].tied = have_same_distance(select, &ranking[i], &ranking[i - 1]) &&
                          merit_of(select, &ranking[i]) == merit_of(select, &ranking[i - 1]);
        ranking[i - 1].tied |= ranking[i].tied;
    }
}

static uint32_t method_of(const vdna_select *select)
{
    if (is_by_transfer(&select->config))
        return VDNA_SELECT_BY_TRANSFER;
    return select->is_early ? VDNA_SELECT_BY_RELATIVE : VDNA_SELECT_BY_EMD;
}

/* see select_state.h */
void vdna_select_judge(vdna_select *select)
{
    if (!select->config.trust)
        return;
    for (uint32_t i = 0; i < select->config.candidate_count; i++)
        select->of_candidates[select->ranking[i].candidate] = select->ranking[i].distance_bins;
    vdna_trust_predict(select->config.trust, select->of_candidates, select->predictions,
                       &select->trusted);
    select->ranked_by = method_of(select);
    if (select->ranked_by == VDNA_SELECT_BY_EMD)
        return;
    order_by_merit(select);
    make_first_exact(select);
    mark_ties(select);
}

/* ---- Accessors ---- */

static int has_trusted(const vdna_select *select)
{
    return vdna_select_state(select) != VDNA_SELECT_WARMUP && select->config.trust;
}

/* see vdna/select.h */
const vdna_trust_answer *vdna_select_trust(const vdna_select *select)
{
    return has_trusted(select) ? &select->trusted : NULL;
}

/* see vdna/select.h */
const vdna_trust_prediction *vdna_select_predictions(const vdna_select *select, uint32_t *out_count)
{
    const int is_there = has_trusted(select);
    if (out_count)
        *out_count = is_there ? select->config.candidate_count : 0;
    return is_there ? select->predictions : NULL;
}
