/* Any sequence of calls that localise and select: maps, localisers and a selector over them, with
 * frames and configurations that may be wrong. Answers are within what the headers say, every frame
 * is counted once, and errors change nothing. */
#include <vdna/select.h>

#include "calls.h"

enum { NEURONS = 2, DIM = 3, LAST = 2, FRAMES = 6, CANDIDATES = 3, CALLS = 48 };

/* Larger objects are not made: they would take most of the time. */
#define SIZE_TRIED 20000u

/* A stored run: its frames, its Visual DNA, and a localiser in it, each in its block. */
typedef struct run {
    uint32_t frames;
    float *embeddings;
    void *hist_mem, *map_mem, *mem;
    size_t mem_size;
    vdna_hist hist;
    vdna_localise_map *map;
    vdna_localise *localise; /* NULL = not made */
} run;

typedef struct machine {
    float range[NEURONS][2];
    run runs[CANDIDATES];
    vdna_select_candidate candidates[CANDIDATES];
    vdna_localise *localisers[CANDIDATES];
    uint32_t count; /* of the selector's candidates */
    int localises;  /* the selector has localisers */
    void *mem;
    vdna_select *select; /* NULL = not made */
    vdna_trust_run trusted[CANDIDATES];
    int8_t codes[CANDIDATES][FRAMES][LAST];
    float scales[CANDIDATES][FRAMES];
    void *trust_mem;
    vdna_trust *trust;              /* of the selector; NULL = none */
    int has_excluded, has_included; /* ever */
    int has_bounds;                 /* whether a ranking may have them */
    uint64_t fed;
    int64_t stamp;
} machine;

static void drop_select(machine *m)
{
    free(m->mem);
    free(m->trust_mem);
    m->mem = m->trust_mem = NULL;
    m->select = NULL;
    m->trust = NULL;
}

/* ---- what is stored */

static void make_map(calls *c, run *r)
{
    vdna_localise_map_config config;
    vdna_localise_map_config_init(&config);
    config.frames = r->frames = 1 + below(c, FRAMES);
    config.dim = DIM;
    config.centred = below(c, 2);
    config.embeddings = r->embeddings = floats_of(c, (size_t)r->frames * DIM);
    const size_t size = vdna_localise_map_mem_size(&config);
    r->map_mem = block_of(size);
    MUST(vdna_localise_map_init(&config, r->map_mem, size - 1, &r->map) == VDNA_ERR_NOMEM);
    const vdna_status status = vdna_localise_map_init(&config, r->map_mem, size, &r->map);
    const int is_finite = all_finite(r->embeddings, (size_t)r->frames * DIM);
    MUST(status == (is_finite ? VDNA_OK : VDNA_ERR_NONFINITE));
    if (status != VDNA_OK) {
        for (size_t i = 0; i < (size_t)r->frames * DIM; i++)
            if (!isfinite(r->embeddings[i]))
                r->embeddings[i] = 0;
        MUST(vdna_localise_map_init(&config, r->map_mem, size, &r->map) == VDNA_OK);
    }
    MUST(vdna_localise_map_step(r->map) >= 0 && isfinite(vdna_localise_map_mean(r->map)[DIM - 1]));
}

static void make_hist(calls *c, machine *m, run *r)
{
    vdna_hist_config config;
    vdna_hist_config_init(&config);
    config.neurons = NEURONS;
    config.bins = 4 + seldom(c, 32);
    config.range = &m->range[0][0];
    const size_t size = vdna_hist_mem_size(&config);
    r->hist_mem = block_of(size);
    MUST(vdna_hist_init(&config, r->hist_mem, size, &r->hist) == VDNA_OK);
    for (uint32_t left = below(c, 4); left > 0; left--) {
        float *values = floats_of(c, NEURONS);
        const vdna_activations tap = {values, NEURONS, 1, VDNA_LAYOUT_SAMPLES_NEURONS};
        vdna_hist_add(&r->hist, &tap, 1);
        free(values);
    }
}

static void make_run(calls *c, machine *m, size_t i)
{
    run *r = &m->runs[i];
    make_map(c, r);
    make_hist(c, m, r);
    vdna_hist_view_of(&r->hist, &m->candidates[i].dna);
    m->candidates[i].embeddings = r->embeddings;
    m->candidates[i].frames = r->frames;
    for (size_t f = 0; f < FRAMES; f++) {
        m->scales[i][f] = next_byte(c) / 255.0f;
        for (size_t k = 0; k < LAST; k++)
            m->codes[i][f][k] = (int8_t)(next_byte(c) - 128);
    }
}

/* A map of another shape is refused, or has a size. */
static void measure_map(calls *c, machine *m)
{
    vdna_localise_map_config config;
    vdna_localise_map *map = NULL;
    vdna_localise_map_config_init(&config);
    config.struct_size -= seldom(c, 32);
    config.frames = any_count(c, 0);
    config.dim = any_count(c, 0);
    config.centred = below(c, 3);
    config.embeddings = m->runs[0].embeddings;
    if (vdna_localise_map_mem_size(&config) == 0)
        MUST(vdna_localise_map_init(&config, m, sizeof *m, &map) == VDNA_ERR_ARG && !map);
}

/* ---- localisers */

/* The default, or seldom a number that may break the field's rule. */
static void vary(calls *c, double *field, double scale)
{
    if (seldom(c, 4))
        *field = scale * any_float(c);
}

static void any_gears(calls *c, vdna_localise_config *config, vdna_gear gears[VDNA_GEARS_MAX])
{
    config->gears = gears;
    config->gear_count = seldom(c, 16) ? any_count(c, 0) : 1 + below(c, VDNA_GEARS_MAX);
    for (size_t g = 0; g < VDNA_GEARS_MAX; g++) {
        gears[g].first = VDNA_GEAR_FIRST_MIN - 1 + (int32_t)below(c, 14);
        gears[g].share[below(c, VDNA_GEAR_SHARES)] = 0.5;
        gears[g].share[below(c, VDNA_GEAR_SHARES)] += 0.5;
        vary(c, &gears[g].share[0], 1);
    }
}

static void make_localiser(calls *c, machine *m)
{
    vdna_gear gears[VDNA_GEARS_MAX] = {{0}};
    int64_t place[FRAMES];
    vdna_localise_config config;
    run *r = &m->runs[below(c, CANDIDATES)];
    drop_select(m);
    vdna_localise_config_init(&config);
    config.map = r->map;
    config.tolerance = any_count(c, 0);
    for (size_t i = 0; i < FRAMES; i++)
        place[i] = seldom(c, 8) ? any_int64(c) : seldom(c, 8) ? INT64_MIN : below(c, 8);
    config.place = below(c, 2) ? place : NULL;
    if (seldom(c, 3))
        any_gears(c, &config, gears);
    if (seldom(c, 3))
        config.mean_frames = any_count(c, 0);
    if (seldom(c, 3))
        config.mean_frames_max = any_count(c, 0);
    vary(c, &config.gate, 2);
    vary(c, &config.sharpness, 100);
    vary(c, &config.clutter, 1);
    vary(c, &config.jump, 1);
    vary(c, &config.gear_change, 1);
    vary(c, &config.evidence_share, 1);
    for (size_t i = 0; i < 4; i++)
        vary(c, &config.confidence[i], 100);

    const size_t size = vdna_localise_mem_size(&config);
    if (size > SIZE_TRIED)
        return;
    const size_t given = size - (size > 0 && seldom(c, 16));
    void *mem = block_of(given);
    vdna_localise *localise = NULL;
    const vdna_status status = vdna_localise_init(&config, mem, given, &localise);
    MUST(status == (size == 0 ? VDNA_ERR_ARG : given < size ? VDNA_ERR_NOMEM : VDNA_OK));
    MUST((status == VDNA_OK) == (localise != NULL));
    if (status != VDNA_OK) {
        free(mem);
        return;
    }
    free(r->mem);
    r->mem = mem;
    r->mem_size = size;
    r->localise = localise;
}

static void check_answer(const run *r, const vdna_localise_answer *a)
{
    MUST(a->frame < r->frames && a->nearest < r->frames && a->moving <= 1 && a->reserved == 0);
    MUST(a->confidence >= 0 && a->confidence <= 1);
    MUST(a->mass >= 0 && a->mass <= 1 - 1e-9);
}

static void check_localiser(const run *r)
{
    double posterior[FRAMES], sum = 0;
    vdna_localise_posterior(r->localise, posterior);
    for (size_t i = 0; i < r->frames; i++) {
        MUST(posterior[i] >= 0 && posterior[i] <= 1 + 1e-9);
        sum += posterior[i];
    }
    MUST(fabs(sum - 1) < 1e-9);
    const double *mean = vdna_localise_mean(r->localise);
    MUST(isfinite(mean[0] + mean[DIM - 1]));
    MUST(isfinite(vdna_localise_evidence(r->localise)));
    MUST(vdna_localise_jumps(r->localise) <= 64);
    MUST(vdna_localise_frames(r->localise) == r->frames);
    MUST(vdna_localise_dim(r->localise) == DIM);
}

static run *a_localiser(calls *c, machine *m)
{
    run *r = &m->runs[below(c, CANDIDATES)];
    return r->localise ? r : NULL;
}

static void feed(calls *c, machine *m)
{
    const run *r = a_localiser(c, m);
    if (!r)
        return;
    const int is_warmup = below(c, 4) == 0;
    float *embedding = floats_of(c, DIM);
    vdna_localise_answer answer;
    const snapshot before = snapshot_of(r->mem, r->mem_size);
    const vdna_status status = is_warmup ? vdna_localise_warm_up(r->localise, embedding)
                                         : vdna_localise_feed(r->localise, embedding, &answer);
    MUST(status == (all_finite(embedding, DIM) ? VDNA_OK : VDNA_ERR_NONFINITE));
    require_unchanged_on_error(before, status);
    if (status == VDNA_OK && !is_warmup) {
        check_answer(r, &answer);
        MUST(answer.nearest_distance >= 0 && answer.nearest_distance <= 2);
        MUST((float)answer.nearest_distance ==
             vdna_localise_distances(r->localise)[answer.nearest]);
    }
    check_localiser(r);
    free(embedding);
}

static void feed_distances(calls *c, machine *m)
{
    const run *r = a_localiser(c, m);
    if (!r)
        return;
    float *distances = floats_of(c, r->frames);
    vdna_localise_answer answer;
    const snapshot before = snapshot_of(r->mem, r->mem_size);
    const vdna_status status = vdna_localise_feed_distances(r->localise, distances, &answer);
    MUST(status == VDNA_OK || status == VDNA_ERR_NONFINITE);
    require_unchanged_on_error(before, status);
    if (status == VDNA_OK) {
        MUST(all_finite(distances, r->frames) && answer.moving == 1);
        check_answer(r, &answer);
    }
    check_localiser(r);
    free(distances);
}

static void reset_localiser(calls *c, machine *m)
{
    const run *r = a_localiser(c, m);
    if (!r)
        return;
    vdna_localise_reset(r->localise);
    MUST(vdna_localise_evidence(r->localise) == 0);
    check_localiser(r);
}

/* ---- the selector */

/* Trust that knows nothing, or that every run found all others as near as one number says. */
static vdna_trust *any_trust(calls *c, machine *m, uint32_t runs)
{
    vdna_trust_cell cells[CANDIDATES * CANDIDATES];
    uint32_t frames[CANDIDATES];
    double own_scale[CANDIDATES], correlation[CANDIDATES];
    const double nearest = 2 * next_byte(c) / 255.0, recall = next_byte(c) / 255.0;
    const int is_by_likeness = (int)below(c, 2), is_labelled = (int)below(c, 2);
    for (uint32_t i = 0; i < CANDIDATES * CANDIDATES; i++)
        for (uint32_t w = 0; w < VDNA_TRUST_WINDOWS; w++) {
            cells[i].nearest[w] = nearest;
            cells[i].likeness[w] = is_by_likeness ? nearest : (double)NAN;
            cells[i].recall[w] = is_labelled ? recall : (double)NAN;
            cells[i].distance[w] = is_labelled ? 1 + i % 3 : (double)NAN;
        }
    for (uint32_t i = 0; i < CANDIDATES; i++) {
        frames[i] = m->runs[i].frames;
        own_scale[i] = 1;
        correlation[i] = below(c, 2) ? 1 : (double)NAN;
        const vdna_trust_run stored = {.embeddings = m->runs[i].embeddings,
                                       .last_layer = m->codes[i][0],
                                       .last_layer_scale = m->scales[i],
                                       .frames = m->runs[i].frames,
                                       .dim = DIM,
                                       .last_layer_dim = LAST};
        m->trusted[i] = stored;
    }
    const vdna_trust_tables tables = {frames, own_scale, correlation, cells};
    vdna_trust_config config;
    vdna_trust_config_init(&config);
    config.runs = runs;
    config.tables = below(c, 4) ? &tables : NULL;
    config.min_recall = below(c, 2);
    config.switch_cost = 1 + below(c, 4);
    const size_t size = vdna_trust_mem_size(&config);
    m->trust_mem = block_of(size);
    vdna_trust *trust = NULL;
    MUST(vdna_trust_init(&config, m->trust_mem, size, &trust) == VDNA_OK);
    MUST(vdna_trust_runs(trust) == runs);
    return trust;
}

static void make_select(calls *c, machine *m)
{
    int are_made = 1;
    drop_select(m);
    for (size_t i = 0; i < CANDIDATES; i++) {
        m->localisers[i] = m->runs[i].localise;
        are_made &= m->localisers[i] != NULL;
    }
    vdna_select_config config;
    vdna_select_config_init_sized(&config, sizeof config - seldom(c, 16));
    config.candidate_count = seldom(c, 32) ? 0 : 1 + below(c, CANDIDATES);
    config.candidates = m->candidates;
    config.dim = seldom(c, 32) ? any_count(c, 0) : DIM;
    config.warmup_frames = below(c, 2) ? below(c, 16) : 0;
    config.warmup_us = config.warmup_frames == 0 || seldom(c, 32) ? below(c, 8) : 0;
    config.warmup_frames_min = seldom(c, 8) ? any_count(c, 0) : below(c, 3);
    config.late_us = seldom(c, 16) ? any_int64(c) : below(c, 4);
    config.time_unit = below(c, 6);
    config.localisers = are_made && below(c, 4) ? m->localisers : NULL;
    config.top = config.localisers ? below(c, CANDIDATES + 1) : 1;
    if (config.candidate_count > 0 && below(c, 2) && config.struct_size == sizeof config) {
        m->trust = config.trust = any_trust(c, m, config.candidate_count);
        config.runs = seldom(c, 32) ? NULL : m->trusted;
    }
    config.rank = below(c, 3) + (seldom(c, 32) ? any_count(c, 0) : 0);
    config.stop_early = below(c, 2);
    config.reselect = below(c, 2);
    config.exact = below(c, CANDIDATES + 1);
    const size_t size = vdna_select_mem_size(&config);
    if (size > SIZE_TRIED)
        return;
    const size_t given = size - (size > 0 && seldom(c, 16));
    m->mem = block_of(given);
    const vdna_status status = vdna_select_init(&config, m->mem, given, &m->select);
    MUST((status == VDNA_ERR_ARG) == (size == 0));
    MUST((status == VDNA_OK) == (m->select != NULL));
    if (config.dim != DIM) /* nobody can check the length of our embeddings */
        drop_select(m);
    m->count = config.candidate_count;
    m->has_bounds = config.exact > 0;
    m->localises = config.localisers != NULL;
    m->has_excluded = m->has_included = 0;
    m->fed = 0;
}

static void check_ranking(const machine *m)
{
    uint32_t count = 0, found = 0;
    const vdna_rank_entry *ranking = vdna_select_ranking(m->select, &count);
    MUST(count == m->count);
    for (uint32_t i = 0; i < count; i++)
        found |= 1u << ranking[i].candidate;
    MUST(found == (1u << count) - 1);
    for (uint32_t i = 0; i <= count; i++)
        MUST(vdna_select_is_bound(m->select, i) <= (i < count && m->has_bounds));
    const uint32_t pinned = vdna_select_pinned(m->select), chosen = vdna_select_chosen(m->select);
    MUST(!vdna_select_is_excluded(m->select, ranking[0].candidate));
    MUST(chosen == (pinned == VDNA_SELECT_NONE ? ranking[0].candidate : pinned) ||
         vdna_select_in_shadow(m->select));
    for (uint32_t i = 1; i < count; i++)
        MUST(vdna_select_is_excluded(m->select, ranking[i].candidate) ||
             !vdna_select_is_excluded(m->select, ranking[i - 1].candidate) || m->has_included);
    MUST(vdna_select_margin_bins(m->select) >= 0 ||
         vdna_select_ranked_by(m->select) != VDNA_SELECT_BY_EMD ||
         vdna_select_switches(m->select) > 0 || m->has_excluded);
}

static void check_trust(const machine *m)
{
    const vdna_select *s = m->select;
    uint32_t count = 0;
    const vdna_trust_answer *trust = vdna_select_trust(s);
    const vdna_trust_prediction *predictions = vdna_select_predictions(s, &count);
    MUST((trust != NULL) == (m->trust && vdna_select_state(s) != VDNA_SELECT_WARMUP));
    MUST((predictions != NULL) == (trust != NULL) && count == (trust ? m->count : 0));
    for (uint32_t i = 0; i < count; i++)
        MUST(isnan(predictions[i].recall) == (predictions[i].reason != VDNA_TRUST_REASON_NONE));
    if (vdna_select_state(s) == VDNA_SELECT_NONE_FITS)
        MUST(trust->verdict != VDNA_TRUST_FITS);
    MUST(vdna_select_ranked_by(s) <= VDNA_SELECT_BY_RELATIVE);
    MUST(vdna_select_is_early(s) <= (vdna_select_state(s) == VDNA_SELECT_WARMUP ? 0u : 1u));
    MUST(vdna_select_previous(s) < m->count && (!vdna_select_is_lost(s) || m->localises));
}

static void check_select(const machine *m)
{
    const vdna_select *s = m->select;
    const double progress = vdna_select_progress(s);
    MUST(progress >= 0 && progress <= 1);
    MUST(vdna_select_accepted(s) + vdna_select_rejected(s) + vdna_select_time(s)->late == m->fed);
    MUST((vdna_select_ranking(s, NULL) != NULL) == (vdna_select_state(s) != VDNA_SELECT_WARMUP));
    MUST(vdna_select_first_utime(s) <= vdna_select_last_utime(s));
    MUST((vdna_restart_text(vdna_select_restart_cause(s))[0] == '\0') ==
         (vdna_select_restarts(s) == 0));
    MUST((vdna_select_restart_cause(s) == VDNA_RESTART_NONE) == (vdna_select_restarts(s) == 0));
    vdna_hist_view live;
    vdna_select_live(s, &live);
    for (size_t n = 0; n < NEURONS; n++) {
        uint64_t sum = 0;
        for (size_t b = 0; b < live.bins; b++)
            sum += live.counts[b * NEURONS + n];
        MUST(sum == live.mass[n]);
    }
    if (vdna_select_state(s) != VDNA_SELECT_WARMUP)
        check_ranking(m);
    check_trust(m);
    const vdna_select_position *where = vdna_select_where(s);
    MUST(!where || (m->localises && where->candidate < m->count));
    if (where)
        check_answer(&m->runs[where->candidate], &where->answer);
}

static void check_select_answer(const machine *m, const vdna_select_answer *answer)
{
    const vdna_select_position *where = vdna_select_where(m->select);
    MUST(answer->state == vdna_select_state(m->select) && answer->newly_ranked <= 1);
    MUST(answer->restarted <= VDNA_RESTART_UNIT && answer->localised <= 1);
    MUST(!answer->localised || vdna_select_has_choice(m->select));
    MUST(!answer->localised ||
         !vdna_select_is_excluded(m->select,
                                  where ? where->candidate : vdna_select_chosen(m->select)));
    const uint32_t in = where ? where->candidate : vdna_select_chosen(m->select);
    if (answer->localised)
        MUST(answer->match.index < m->runs[in].frames && answer->match.distance_sq >= 0);
}

static void feed_select(calls *c, machine *m)
{
    if (!m->select)
        return;
    const uint32_t samples = 1 + below(c, 3), neurons = NEURONS + seldom(c, 32);
    float *values = floats_of(c, (size_t)samples * neurons), *embedding = floats_of(c, DIM);
    float *last_layer = below(c, 8) ? floats_of(c, LAST) : NULL;
    const vdna_activations tap = {values, neurons, samples, below(c, 2)};
    m->stamp = seldom(c, 16) ? any_int64(c) : (int64_t)((uint64_t)m->stamp + below(c, 4));
    const vdna_select_frame frame = {m->stamp, &tap, 1, seldom(c, 64) ? NULL : embedding};
    const uint32_t state = vdna_select_state(m->select);
    const uint32_t frames = vdna_select_window_frames(m->select);
    vdna_select_answer answer;
    memset(&answer, 0xA5, sizeof answer);
    const snapshot before = snapshot_of(&answer, sizeof answer);
    const vdna_status status = last_layer
                                   ? vdna_select_feed_seen(m->select, &frame, last_layer, &answer)
                                   : vdna_select_feed(m->select, &frame, &answer);
    require_unchanged_on_error(before, status);
    m->fed++;
    if (status == VDNA_OK)
        check_select_answer(m, &answer);
    else if (status == VDNA_ERR_OVERFLOW || status == VDNA_ERR_FULL)
        MUST(vdna_select_state(m->select) == VDNA_SELECT_WARMUP);
    else
        MUST(vdna_select_state(m->select) == state &&
             vdna_select_window_frames(m->select) == frames);
    check_select(m);
    free(values);
    free(embedding);
    free(last_layer);
}

/* Drive through a stored run: some of its frames, in some order. */
static void drive_select(calls *c, machine *m)
{
    const run *r = &m->runs[below(c, CANDIDATES)];
    const uint32_t step = below(c, FRAMES), frames = below(c, 80);
    const float light = any_float(c), last_layer[LAST] = {any_float(c), any_float(c)};
    const float values[NEURONS] = {any_float(c), any_float(c)};
    const vdna_activations tap = {values, NEURONS, 1, VDNA_LAYOUT_SAMPLES_NEURONS};
    for (uint32_t i = 0; m->select && i < frames; i++) {
        float embedding[DIM];
        for (size_t k = 0; k < DIM; k++)
            embedding[k] = r->embeddings[i * step % r->frames * DIM + k] + light;
        m->stamp = (int64_t)((uint64_t)m->stamp + 1);
        const vdna_select_frame frame = {m->stamp, &tap, 1, embedding};
        vdna_select_answer answer;
        if (vdna_select_feed_seen(m->select, &frame, last_layer, &answer) == VDNA_OK)
            check_select_answer(m, &answer);
        m->fed++;
        check_select(m);
    }
}

static void reset_select(calls *c, machine *m)
{
    if (!m->select || !seldom(c, 4))
        return;
    vdna_select_reset(m->select);
    MUST(vdna_select_state(m->select) == VDNA_SELECT_WARMUP &&
         vdna_select_window_frames(m->select) == 0);
    check_select(m);
}

static void command_select(calls *c, machine *m)
{
    vdna_select *s = m->select;
    if (!s)
        return;
    const uint32_t candidate = seldom(c, 8) ? any_count(c, 0) : below(c, CANDIDATES);
    const uint32_t on = seldom(c, 16) ? any_count(c, 0) : below(c, 2);
    const uint32_t pinned = vdna_select_pinned(s), shadow = vdna_select_in_shadow(s);
    const uint32_t excluded = vdna_select_is_excluded(s, candidate);
    switch (below(c, 5)) {
    case 0:
        if (vdna_select_pin(s, candidate) == VDNA_OK)
            MUST(vdna_select_pinned(s) == candidate && !excluded);
        else
            MUST(vdna_select_pinned(s) == pinned && (excluded || candidate >= m->count));
        break;
    case 1:
        MUST(vdna_select_pin(s, VDNA_SELECT_NONE) == VDNA_OK);
        MUST(vdna_select_pinned(s) == VDNA_SELECT_NONE);
        break;
    case 2:
        MUST((vdna_select_shadow(s, on) == VDNA_OK) == (on <= 1));
        MUST(vdna_select_in_shadow(s) == (on <= 1 ? on : shadow));
        break;
    case 3:
        vdna_select_catch_up(s);
        break;
    default:
        if (vdna_select_exclude(s, candidate, on) == VDNA_OK)
            MUST(vdna_select_is_excluded(s, candidate) == on && (!on || candidate != pinned));
        else
            MUST(vdna_select_is_excluded(s, candidate) == excluded);
        m->has_excluded |= vdna_select_is_excluded(s, candidate) != 0;
        m->has_included |= excluded && !vdna_select_is_excluded(s, candidate);
    }
    check_select(m);
}

/* ---- the program */

static void (*const operations[])(calls *, machine *) = {
    measure_map,     make_localiser, make_localiser, feed,          feed,        feed_distances,
    reset_localiser, make_select,    make_select,    feed_select,   feed_select, feed_select,
    drive_select,    reset_select,   command_select, command_select};

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    calls c = {bytes, bytes + size};
    machine m;
    memset(&m, 0, sizeof m);
    for (size_t n = 0; n < NEURONS; n++) {
        m.range[n][0] = -1;
        m.range[n][1] = 1;
    }
    for (size_t i = 0; i < CANDIDATES; i++)
        make_run(&c, &m, i);
    for (size_t left = CALLS; left > 0 && has_more(&c); left--)
        operations[below(&c, sizeof operations / sizeof *operations)](&c, &m);
    drop_select(&m);
    for (size_t i = 0; i < CANDIDATES; i++) {
        free(m.runs[i].mem);
        free(m.runs[i].map_mem);
        free(m.runs[i].hist_mem);
        free(m.runs[i].embeddings);
    }
    return 0;
}

size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity)
{
    return index < 16 && capacity >= PROGRAM ? random_program(index, out) : 0;
}
