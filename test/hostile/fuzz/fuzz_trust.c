/* Any tables of a map, made up or measured on runs of a few frames, and any sequence of calls that
 * trust a choice by them: what is told is within what the header says, and errors change nothing.
 */
#include <vdna/trust.h>

#include "calls.h"

enum { RUNS = 6, DIM = 3, CODES = 4, FRAMES = 24, CALLS = 48 };

/* A stored run in exact blocks. */
typedef struct stored {
    vdna_trust_run run;
    float *embeddings, *scales;
    int8_t *codes;
    int64_t *place;
    double *position;
} stored;

typedef struct machine {
    uint32_t runs, frames[RUNS];
    double own_scale[RUNS], correlation[RUNS];
    vdna_trust_cell cells[RUNS][RUNS];
    vdna_trust *trust; /* NULL = not made */
    void *mem;
    size_t mem_size;
    uint32_t fed;
    int has_chosen;
} machine;

static int is_within(double number, double least, double most)
{
    return number >= least && number <= most;
}

static int is_share_or_nan(double number)
{
    return isnan(number) || is_within(number, 0, 1);
}

/* ---- what a map tells about itself */

static stored any_run(calls *c)
{
    stored s;
    memset(&s, 0, sizeof s);
    const size_t frames = 1 + below(c, FRAMES);
    s.embeddings = floats_of(c, frames * DIM);
    s.scales = floats_of(c, frames);
    s.codes = block_of(frames * CODES);
    s.place = block_of(frames * sizeof *s.place);
    s.position = doubles_of(c, 3 * frames);
    for (size_t i = 0; i < frames; i++) {
        if (s.scales[i] < 0)
            s.scales[i] = -s.scales[i];
        s.place[i] = seldom(c, 16) ? any_int64(c) : next_byte(c) / 16;
        for (size_t k = 0; k < CODES; k++)
            s.codes[i * CODES + k] = (int8_t)(next_byte(c) - 128);
    }
    s.run.embeddings = s.embeddings;
    s.run.frames = (uint32_t)frames;
    s.run.dim = DIM;
    s.run.place = below(c, 4) ? s.place : NULL;
    s.run.position = below(c, 2) ? s.position : NULL;
    if (below(c, 2)) {
        s.run.last_layer = s.codes;
        s.run.last_layer_scale = seldom(c, 32) ? NULL : s.scales;
        s.run.last_layer_dim = CODES;
    }
    return s;
}

static void free_run(stored *s)
{
    free(s->embeddings);
    free(s->scales);
    free(s->codes);
    free(s->place);
    free(s->position);
}

static void check_cell(const vdna_trust_cell *cell, uint32_t windows)
{
    for (uint32_t w = 0; w < VDNA_TRUST_WINDOWS; w++) {
        const int is_window = w < windows;
        MUST(is_window ? is_within(cell->nearest[w], 0, 2) : isnan(cell->nearest[w]));
        MUST(isnan(cell->likeness[w]) || (is_window && is_within(cell->likeness[w], 0, 2)));
        MUST(isnan(cell->recall[w]) || (is_window && is_within(cell->recall[w], 0, 1)));
        MUST(isnan(cell->distance[w]));
    }
}

/* One stored run against another, whose cell becomes one of the tables'. */
static void pair(calls *c, machine *m)
{
    stored live = any_run(c), candidate = any_run(c);
    const double tolerance = 4 * any_float(c);
    const size_t size = vdna_trust_pair_scratch_size(&live.run, &candidate.run);
    void *scratch = block_of(size);
    double *relative = block_of(live.run.frames * sizeof *relative), own = -1;
    vdna_trust_cell cell;
    const vdna_status status = vdna_trust_pair(&live.run, &candidate.run, tolerance, below(c, 3),
                                               scratch, size, relative, &cell);
    if (status == VDNA_OK) {
        check_cell(&cell, vdna_trust_windows(live.run.frames, NULL, NULL));
        for (uint32_t i = 0; i < live.run.frames; i++)
            MUST(is_within(relative[i], 0, 2));
        m->cells[below(c, RUNS)][below(c, RUNS)] = cell;
        MUST(vdna_trust_pair(&live.run, &candidate.run, tolerance, VDNA_TRUST_CENTRED, scratch,
                             size - 1, relative, &cell) == VDNA_ERR_NOMEM);
    }
    const vdna_status owned = vdna_trust_own_scale(&live.run, tolerance, &own);
    MUST(owned == VDNA_OK ? is_within(own, 1e-6, 2) : own == -1);
    free(scratch);
    free(relative);
    free_run(&live);
    free_run(&candidate);
}

static void correlate(calls *c, machine *m)
{
    (void)m;
    const uint32_t candidates = below(c, 5), frames = below(c, 40);
    const size_t pairs = candidates > 0 ? candidates * (candidates - 1) / 2 : 0;
    double *relative = block_of(candidates * frames * sizeof *relative);
    double *scratch = block_of(pairs * sizeof *scratch), tau = -1;
    for (size_t i = 0; i < candidates * frames; i++)
        relative[i] = next_byte(c) / 128.0;
    const vdna_status status =
        vdna_trust_correlation_time(relative, candidates, frames, scratch, &tau);
    MUST(status == VDNA_OK ? isnan(tau) || (tau >= 0 && isfinite(tau)) : tau == -1);
    free(relative);
    free(scratch);
}

static void nearest_of_codes(calls *c, machine *m)
{
    (void)m;
    stored run = any_run(c);
    int8_t codes[CODES];
    for (size_t k = 0; k < CODES; k++)
        codes[k] = (int8_t)(next_byte(c) - 128);
    double relative = -1;
    const float scale = any_float(c);
    const vdna_status status = vdna_trust_nearest_int8(codes, scale, run.codes, run.scales, CODES,
                                                       run.run.frames, &relative);
    MUST(status == VDNA_OK ? is_within(relative, 0, 2) : relative == -1);
    MUST(status == VDNA_OK || status == VDNA_ERR_NONFINITE);
    free_run(&run);
}

static void nearest_of_floats(calls *c, machine *m)
{
    (void)m;
    stored run = any_run(c);
    float *embedding = floats_of(c, DIM);
    double relative = -1;
    uint32_t index = UINT32_MAX;
    const vdna_status status =
        vdna_trust_nearest(embedding, run.embeddings, DIM, run.run.frames, &relative, &index);
    MUST(status == VDNA_OK ? is_within(relative, 0, 2) && index < run.run.frames
                           : status == VDNA_ERR_NONFINITE && relative == -1);
    double of_run = -1;
    MUST(vdna_trust_nearest_in(embedding, &run.run, &of_run, NULL) == status);
    MUST(memcmp(&of_run, &relative, sizeof relative) == 0);
    free(embedding);
    free_run(&run);
}

/* ---- tables */

/* Numbers about one byte's; one of them is seldom not known, or beyond its range. */
static void any_windows(calls *c, double numbers[VDNA_TRUST_WINDOWS], double most)
{
    const double first = most * next_byte(c) / 255, last = most * next_byte(c) / 255;
    for (size_t w = 0; w < VDNA_TRUST_WINDOWS; w++)
        numbers[w] = first + (last - first) * (double)w / VDNA_TRUST_WINDOWS;
    if (seldom(c, 32))
        numbers[below(c, VDNA_TRUST_WINDOWS)] = below(c, 4) ? (double)NAN : any_float(c);
}

static void any_cell(calls *c, vdna_trust_cell *cell)
{
    any_windows(c, cell->nearest, 2);
    any_windows(c, cell->likeness, 2);
    any_windows(c, cell->recall, 1);
    any_windows(c, cell->distance, 12);
}

/* Row `a` of the tables. */
static void make_row(calls *c, machine *m, size_t a)
{
    m->frames[a] = any_count(c, 1);
    m->own_scale[a] = seldom(c, 64) ? any_float(c) : (1 + below(c, 128)) / 64.0;
    m->correlation[a] = below(c, 4) ? next_byte(c) / 8.0 : (double)NAN;
    for (size_t b = 0; b < RUNS; b++)
        any_cell(c, &m->cells[a][b]);
}

static void any_row(calls *c, machine *m)
{
    make_row(c, m, below(c, RUNS));
}

/* ---- a live run */

static void drop(machine *m)
{
    free(m->mem);
    m->mem = NULL;
    m->trust = NULL;
}

static void check_fit(const machine *m)
{
    const vdna_trust_fit *fit = vdna_trust_fitted(m->trust);
    const int is_fitted = fit->labelled >= VDNA_TRUST_RUNS_MIN;
    MUST(fit->labelled <= m->runs && fit->labelled != 1 && fit->by_likeness <= 1);
    MUST(is_fitted ? fit->skill <= 1 : isnan(fit->skill));
    MUST(is_fitted ? isfinite(fit->slope) : isnan(fit->slope));
    MUST(is_fitted ? fit->sd >= 0 && fit->sd_best >= fit->sd : isnan(fit->sd));
    MUST(isnan(fit->correlation) || fit->correlation >= 1);
    MUST(!isinf(fit->far));
    const double *intercepts = vdna_trust_intercepts(m->trust);
    for (uint32_t b = 0; b < m->runs; b++)
        MUST(is_fitted || isnan(intercepts[b]));
}

static void make(calls *c, machine *m)
{
    vdna_trust_tables tables = {m->frames, m->own_scale, m->correlation, &m->cells[0][0]};
    vdna_trust_cell packed[RUNS][RUNS];
    vdna_trust_config config;
    drop(m);
    vdna_trust_config_init(&config);
    config.runs = m->runs = seldom(c, 32) ? any_count(c, 0) : 1 + below(c, RUNS);
    config.localiser = seldom(c, 32) ? any_count(c, 0) : below(c, 2);
    if (seldom(c, 8))
        config.min_recall = any_float(c);
    if (seldom(c, 8))
        config.switch_cost = 100 * any_float(c);
    const size_t size = vdna_trust_mem_size(&config);
    if (m->runs > RUNS)
        return;
    for (uint32_t a = 0; a < m->runs; a++)
        memcpy(&packed[0][0] + a * m->runs, m->cells[a], m->runs * sizeof **packed);
    tables.cells = &packed[0][0];
    config.tables = seldom(c, 8) ? NULL : &tables;
    m->mem_size = size - (size > 0 && seldom(c, 16));
    m->mem = block_of(m->mem_size);
    const vdna_status status = vdna_trust_init(&config, m->mem, m->mem_size, &m->trust);
    MUST((status == VDNA_OK) == (m->trust != NULL));
    MUST(status != VDNA_OK || vdna_trust_runs(m->trust) == m->runs);
    MUST(status != VDNA_OK || !config.tables ||
         vdna_trust_tables_check(&tables, m->runs) == VDNA_OK);
    MUST(size > 0 || status == VDNA_ERR_ARG);
    MUST(m->mem_size == size || status == VDNA_ERR_NOMEM);
    m->fed = 0;
    m->has_chosen = 0;
    if (m->trust)
        check_fit(m);
}

/* [runs] relative distances; one of them is seldom something else. */
static double *distances(calls *c, const machine *m, double most)
{
    double *all = block_of(m->runs * sizeof *all);
    for (uint32_t b = 0; b < m->runs; b++)
        all[b] = most * next_byte(c) / 255;
    if (seldom(c, 16))
        all[below(c, m->runs)] = any_float(c);
    return all;
}

static void feed(calls *c, machine *m)
{
    double *nearest = distances(c, m, 2), *likeness = distances(c, m, 2);
    const snapshot before = snapshot_of(m->mem, m->mem_size);
    for (uint32_t left = 1 + below(c, 8); left > 0; left--) {
        const vdna_status status = vdna_trust_feed(m->trust, nearest, likeness);
        MUST(status == VDNA_OK || status == VDNA_ERR_NONFINITE);
        MUST(status == VDNA_OK || memcmp(m->mem, before.bytes, before.size) == 0);
        m->fed += status == VDNA_OK;
        nearest[0] = nearest[0] / 2;
    }
    free(before.bytes);
    free(nearest);
    free(likeness);
}

static void check_prediction(const vdna_trust_prediction *p)
{
    const int is_known = p->reason == VDNA_TRUST_REASON_NONE;
    MUST(p->reason <= VDNA_TRUST_REASON_NO_DISTANCE && p->reserved == 0);
    MUST((vdna_trust_reason_text(p->reason)[0] == '\0') == is_known);
    MUST(is_known ? is_within(p->recall, 0, 1) && is_within(p->low, 0, p->recall) &&
                        is_within(p->high, p->recall, 1)
                  : isnan(p->recall) && isnan(p->low) && isnan(p->high));
    MUST(is_share_or_nan(p->transfer));
    MUST(isnan(p->nearest) || (p->nearest >= 0 && isfinite(p->nearest)));
}

static void predict(calls *c, machine *m)
{
    double *bins = distances(c, m, 30);
    vdna_trust_prediction predictions[RUNS];
    vdna_trust_answer answer;
    const vdna_status status =
        vdna_trust_predict(m->trust, seldom(c, 8) ? NULL : bins, predictions, &answer);
    MUST(status == VDNA_OK || status == VDNA_ERR_NONFINITE);
    if (status == VDNA_OK) {
        for (uint32_t b = 0; b < m->runs; b++)
            check_prediction(&predictions[b]);
        MUST(answer.verdict <= VDNA_TRUST_BLANK && answer.frames == m->fed);
        MUST(answer.choice < m->runs && answer.settled_frames <= m->fed);
        MUST(answer.settled_frames == vdna_trust_settled_frames(m->trust));
        MUST(answer.settled_frames == 0 || m->fed >= VDNA_TRUST_SETTLED_FRAMES);
        MUST(!isinf(answer.unlike));
        vdna_trust_answer alone = answer;
        const uint32_t candidate = below(c, m->runs + 1);
        MUST((vdna_trust_judge(m->trust, candidate, predictions, &alone) == VDNA_OK) ==
             (candidate < m->runs));
        MUST(alone.verdict <= VDNA_TRUST_BLANK && alone.choice == answer.choice);
        MUST(!isinf(alone.unlike) && !(alone.unlike < answer.unlike));
    }
    free(bins);
}

static void choose(calls *c, machine *m)
{
    const uint32_t candidate = below(c, m->runs + 1);
    const vdna_status status = vdna_trust_choose(m->trust, candidate);
    MUST(status == (candidate < m->runs ? VDNA_OK : VDNA_ERR_ARG));
    m->has_chosen |= status == VDNA_OK;
}

static void drive(calls *c, machine *m)
{
    double *nearest = distances(c, m, 2), *expected = block_of(m->runs * sizeof *expected);
    double *confidence = below(c, 2) ? distances(c, m, 1) : NULL;
    const vdna_status status = confidence || below(c, 2)
                                   ? vdna_trust_suit(m->trust, nearest, confidence, expected)
                                   : vdna_trust_expect(m->trust, nearest, expected);
    MUST(status == VDNA_OK || status == VDNA_ERR_NONFINITE ||
         (confidence && status == VDNA_ERR_ARG));
    for (uint32_t b = 0; b < m->runs; b++)
        if (status == VDNA_OK)
            MUST(is_share_or_nan(expected[b]));
        else
            expected[b] = any_float(c);
    uint32_t choice = UINT32_MAX;
    const snapshot before = snapshot_of(m->mem, m->mem_size);
    const vdna_status reconsidered =
        vdna_trust_reconsider(m->trust, expected, seldom(c, 16) ? any_count(c, 0) : 5, &choice);
    require_unchanged_on_error(before, reconsidered);
    MUST(reconsidered == VDNA_OK ? m->has_chosen && choice < m->runs
                                 : reconsidered == VDNA_ERR_ARG && choice == UINT32_MAX);
    free(nearest);
    free(expected);
    free(confidence);
}

static void reset(calls *c, machine *m)
{
    (void)c;
    vdna_trust_reset(m->trust);
    m->fed = 0;
    m->has_chosen = 0;
    MUST(vdna_trust_settled_frames(m->trust) == 0);
}

/* ---- the program */

static void (*const of_maps[])(calls *, machine *) = {
    pair, correlate, nearest_of_codes, nearest_of_floats, any_row, make, make};

static void (*const of_live_runs[])(calls *, machine *) = {feed,   feed,  feed,  predict, predict,
                                                           choose, drive, drive, drive,   reset};

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    calls c = {bytes, bytes + size};
    machine m;
    memset(&m, 0, sizeof m);
    for (size_t a = 0; a < RUNS; a++)
        make_row(&c, &m, a);
    for (size_t left = CALLS; left > 0 && has_more(&c); left--)
        if (m.trust && below(&c, 4))
            of_live_runs[below(&c, sizeof of_live_runs / sizeof *of_live_runs)](&c, &m);
        else
            of_maps[below(&c, sizeof of_maps / sizeof *of_maps)](&c, &m);
    drop(&m);
    return 0;
}

size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity)
{
    return index < 16 && capacity >= PROGRAM ? random_program(index, out) : 0;
}
