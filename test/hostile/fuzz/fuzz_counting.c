/* Any sequence of calls that count and compare: ranges, histograms, windows, distances and their
 * bounds, rankings, their reasons, nearest neighbours, 8-bit codes and camera time. Masses are
 * conserved, and errors change nothing.
 */
#include <vdna/camera_time.h>
#include <vdna/explain.h>
#include <vdna/int8.h>
#include <vdna/knn.h>
#include <vdna/rank.h>
#include <vdna/window.h>

#include "calls.h"

enum { NEURONS = 4, TAPS = 2, SAMPLES = 4, HISTS = 3, WINDOWS = 2, CALLS = 64 };

/* Larger objects are not made: they would take most of the time. */
#define SIZE_TRIED 10000u

/* A histogram or a window, its block, and the samples that it should hold per neuron. */
typedef struct counted {
    vdna_hist hist;
    vdna_window *window;
    void *mem; /* NULL = not made */
    size_t mem_size;
    uint64_t mass[NEURONS], frames;
    vdna_activations shape[TAPS]; /* of a window's frames, borrowed by it */
    size_t tap_count;
    uint32_t capacity;
    uint64_t which;
} counted;

typedef struct machine {
    counted hists[HISTS], windows[WINDOWS];
    float ranges[2][NEURONS][2]; /* valid, borrowed by the above */
    float seen[NEURONS][2];      /* observed and expanded */
    vdna_camera_time time;
} machine;

/* A frame in a block of its exact size. */
typedef struct frame {
    vdna_activations taps[TAPS];
    size_t tap_count;
    float *values;
} frame;

/* Taps of any shape; their neurons are seldom not those of our histograms. */
static size_t any_shape(calls *c, vdna_activations taps[TAPS])
{
    const size_t tap_count = 1 + below(c, TAPS);
    const uint32_t neurons = seldom(c, 16) ? 1 + below(c, NEURONS) : NEURONS;
    for (size_t t = 0; t < tap_count; t++) {
        taps[t].values = NULL;
        taps[t].neurons = tap_count == 1 ? neurons : t == 0 ? 1 : neurons - 1;
        taps[t].samples = 1 + below(c, SAMPLES);
        taps[t].layout = seldom(c, 32) ? next_byte(c) : below(c, 2);
    }
    return tap_count;
}

static frame frame_of(calls *c, const vdna_activations *shape, size_t tap_count)
{
    frame f = {{{0}}, tap_count, NULL};
    size_t count = 0;
    for (size_t t = 0; t < tap_count; t++)
        count += (size_t)shape[t].neurons * shape[t].samples;
    const float *values = f.values = floats_of(c, count);
    for (size_t t = 0; t < tap_count; t++) {
        f.taps[t] = shape[t];
        f.taps[t].values = values;
        values += (size_t)shape[t].neurons * shape[t].samples;
    }
    if (seldom(c, 64))
        f.taps[0].values = NULL;
    return f;
}

static void add_mass(uint64_t mass[NEURONS], const frame *f)
{
    size_t n = 0;
    for (size_t t = 0; t < f->tap_count; t++)
        for (size_t i = 0; i < f->taps[t].neurons; i++)
            mass[n++] += f->taps[t].samples;
}

/* Every sample is in one bin; samples beyond the range are among them. */
static void check_hist(const vdna_hist *hist, const uint64_t mass[NEURONS])
{
    for (size_t n = 0; n < hist->neurons; n++) {
        uint64_t sum = 0;
        for (size_t b = 0; b < hist->bins; b++)
            sum += hist->counts[b * hist->neurons + n];
        MUST(sum == mass[n] && hist->mass[n] == sum && hist->saturated[n] <= sum);
    }
}

/* ---- ranges */

/* Two tables, which histograms do not compare across. What a table could not be is -1..1. */
static void make_ranges(calls *c, machine *m)
{
    for (size_t r = 0; r < 2; r++)
        for (size_t n = 0; n < NEURONS; n++) {
            float *edges = m->ranges[r][n];
            edges[0] = any_float(c);
            edges[1] = any_float(c);
            if (vdna_range_check(edges, 1) != VDNA_OK) {
                edges[0] = -1;
                edges[1] = 1;
            }
        }
    MUST(vdna_range_check(&m->ranges[0][0][0], NEURONS) == VDNA_OK);
    MUST(vdna_range_clear(&m->seen[0][0], NEURONS) == VDNA_OK);
}

static const float *a_range(calls *c, machine *m)
{
    return &m->ranges[seldom(c, 8)][0][0];
}

static void observe(calls *c, machine *m)
{
    vdna_activations shape[TAPS];
    const size_t tap_count = any_shape(c, shape);
    const frame f = frame_of(c, shape, tap_count);
    const snapshot before = snapshot_of(m->seen, sizeof m->seen);
    const vdna_status status = vdna_range_observe(&m->seen[0][0], NEURONS, f.taps, tap_count);
    MUST(status == vdna_activations_check(f.taps, tap_count, NEURONS));
    require_unchanged_on_error(before, status);
    free(f.values);
}

static void expand(calls *c, machine *m)
{
    const snapshot before = snapshot_of(m->seen, sizeof m->seen);
    const vdna_status status =
        vdna_range_expand(&m->seen[0][0], NEURONS, 2 * any_float(c) + 1, below(c, 3));
    MUST(status != VDNA_OK || vdna_range_check(&m->seen[0][0], NEURONS) == VDNA_OK);
    require_unchanged_on_error(before, status);
    MUST(vdna_range_clear(&m->seen[0][0], NEURONS) == VDNA_OK);
}

/* ---- histograms */

static void drop(counted *x)
{
    free(x->mem);
    memset(x, 0, sizeof *x);
}

static void make_hist(calls *c, machine *m)
{
    counted *x = &m->hists[below(c, HISTS)];
    drop(x);
    vdna_hist_config config;
    vdna_hist_config_init(&config);
    config.neurons = seldom(c, 16) ? any_count(c, 0) : NEURONS;
    config.bins = any_count(c, VDNA_HIST_BINS_MIN);
    config.range = seldom(c, 32) || config.neurons > NEURONS ? NULL : a_range(c, m);
    config.struct_size += seldom(c, 32);
    const size_t size = vdna_hist_mem_size(&config);
    if (size > SIZE_TRIED)
        return;
    const size_t given = size > 0 && config.range ? size - seldom(c, 16) : 0;
    x->mem = block_of(given);
    const snapshot before = snapshot_of(&x->hist, sizeof x->hist);
    const vdna_status status = vdna_hist_init(&config, x->mem, given, &x->hist);
    require_unchanged_on_error(before, status);
    MUST(status == (size == 0 || !config.range ? VDNA_ERR_ARG
                    : given < size             ? VDNA_ERR_NOMEM
                                               : VDNA_OK));
    x->mem_size = given;
    if (status != VDNA_OK)
        drop(x);
}

/* The histogram that a byte chooses; NULL if it was not made. */
static counted *a_hist(calls *c, machine *m)
{
    counted *x = &m->hists[below(c, HISTS)];
    return x->mem ? x : NULL;
}

static void add(calls *c, machine *m)
{
    counted *x = a_hist(c, m);
    if (!x)
        return;
    vdna_activations shape[TAPS];
    const size_t tap_count = any_shape(c, shape);
    const frame f = frame_of(c, shape, tap_count);
    const snapshot before = snapshot_of(x->mem, x->mem_size);
    const vdna_status status = vdna_hist_add(&x->hist, f.taps, tap_count);
    MUST(status == vdna_activations_check(f.taps, tap_count, x->hist.neurons));
    require_unchanged_on_error(before, status);
    if (status == VDNA_OK) {
        add_mass(x->mass, &f);
        x->frames++;
    }
    free(f.values);
}

static void merge_or_subtract(calls *c, machine *m)
{
    const int is_merge = below(c, 2) == 0;
    counted *x = a_hist(c, m), *y = a_hist(c, m);
    if (!x || !y || x == y)
        return;
    const snapshot before = snapshot_of(x->mem, x->mem_size);
    const vdna_status status =
        is_merge ? vdna_hist_merge(&x->hist, &y->hist) : vdna_hist_subtract(&x->hist, &y->hist);
    require_unchanged_on_error(before, status);
    MUST(status == VDNA_OK || status == VDNA_ERR_MISMATCH ||
         status == (is_merge ? VDNA_ERR_FULL : VDNA_ERR_UNDERFLOW));
    for (size_t n = 0; n < NEURONS && status == VDNA_OK; n++)
        x->mass[n] += is_merge ? y->mass[n] : 0 - y->mass[n];
    if (status == VDNA_OK)
        x->frames += is_merge ? y->frames : 0 - y->frames;
}

static void reset_hist(calls *c, machine *m)
{
    counted *x = a_hist(c, m);
    if (!x)
        return;
    vdna_hist_reset(&x->hist);
    memset(x->mass, 0, sizeof x->mass);
    x->frames = 0;
}

/* ---- distances */

static void check_distance(const vdna_hist_view *p, const vdna_hist_view *q)
{
    const size_t size = vdna_emd_scratch_size(p->neurons);
    void *scratch = block_of(size);
    double each[NEURONS], mean = -1, back = -1, sum = 0;
    const vdna_status status = vdna_emd_mean(p, q, scratch, size, &mean);
    MUST(status == vdna_emd(p, q, scratch, size, each));
    MUST(status == vdna_hist_view_check_pair(p, q));
    if (status == VDNA_OK) {
        MUST(vdna_emd_mean(p, q, scratch, size - 1, &back) == VDNA_ERR_NOMEM && back == -1);
        MUST(vdna_emd_mean(q, p, scratch, size, &back) == VDNA_OK && back == mean);
        for (size_t n = 0; n < p->neurons; n++) {
            double bin = -1;
            MUST(each[n] >= 0 && each[n] <= p->bins - 1);
            MUST(vdna_hist_view_mean(p, (uint32_t)n, &bin) == VDNA_OK);
            MUST(bin >= 0 && bin <= p->bins - 1);
            sum += each[n];
        }
        MUST(fabs(mean - sum / p->neurons) <= 1e-9 * p->bins);
        MUST(vdna_emd_mean(p, p, scratch, size, &mean) == VDNA_OK && mean == 0);
    } else {
        MUST(mean == -1);
    }
    free(scratch);
}

static void check_ranking(const vdna_rank_entry *ranking, uint32_t count)
{
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; i++) {
        found |= 1u << ranking[i].candidate;
        const double here = ranking[i].distance_bins;
        MUST(i == 0 || ranking[i - 1].distance_bins < here ||
             (ranking[i - 1].distance_bins == here &&
              ranking[i - 1].candidate < ranking[i].candidate));
        MUST(ranking[i].tied == ((i > 0 && ranking[i - 1].distance_bins == here) ||
                                 (i + 1 < count && ranking[i + 1].distance_bins == here)));
    }
    MUST(found == (1u << count) - 1);
}

/* The block sums of all, one after the other.
 * @param views  of one shape, none empty */
static uint32_t *sums_of(const vdna_hist_view *views, uint32_t count)
{
    const size_t size = vdna_bounds_size(views[0].neurons, views[0].bins);
    const size_t scratch_size = vdna_emd_scratch_size(views[0].neurons);
    uint32_t *sums = block_of(size * count);
    void *scratch = block_of(scratch_size);
    for (uint32_t i = 0; i < count; i++)
        MUST(vdna_bounds_sum(&views[i], scratch, scratch_size, sums + i * (size / sizeof *sums)) ==
             VDNA_OK);
    free(scratch);
    return sums;
}

/* @param ranking  of vdna_rank() */
static void check_top(const vdna_hist_view *live, const vdna_hist_view *views, uint32_t count,
                      uint32_t exact, const vdna_rank_entry *ranking)
{
    const size_t size = vdna_rank_top_scratch_size(live->neurons, live->bins);
    const size_t numbers = vdna_bounds_size(live->neurons, live->bins) / sizeof(uint32_t);
    void *scratch = block_of(size);
    uint32_t *sums = sums_of(views, count), *live_sums = sums_of(live, 1);
    vdna_rank_entry top[HISTS];
    uint8_t is_bound[HISTS];
    MUST(vdna_rank_top(live, views, sums, count, exact, scratch, size, top, is_bound) ==
         (exact == 0 ? VDNA_ERR_ARG : VDNA_OK));
    for (uint32_t i = 0; i < count && i < exact; i++)
        MUST(memcmp(&top[i], &ranking[i], sizeof *top) == 0 && !is_bound[top[i].candidate]);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t candidate = ranking[i].candidate;
        double bound = -1, of_sums = -1;
        MUST(vdna_bounds_mean(live, live_sums, &views[candidate], sums + candidate * numbers,
                              scratch, size, &bound) == VDNA_OK);
        MUST(vdna_bounds_from_sums(live_sums, live->mass, sums + candidate * numbers,
                                   views[candidate].mass, live->neurons, live->bins, scratch, size,
                                   &of_sums) == VDNA_OK);
        MUST(of_sums == bound);
        MUST(bound >= 0 && bound <= ranking[i].distance_bins);
    }
    free(scratch), free(sums), free(live_sums);
}

/* Each of some Visual DNAs with each, as often as fills a group.
 * @param views  of one shape */
static void check_block(const vdna_hist_view *views, uint32_t count)
{
    enum { SIDE = 2 * HISTS };
    vdna_hist_view side[SIDE];
    double distances[SIDE][SIDE];
    const size_t size = vdna_emd_block_scratch_size(views[0].neurons);
    void *scratch = block_of(size);
    for (uint32_t i = 0; i < SIDE; i++)
        side[i] = views[i % count];
    MUST(vdna_emd_block(side, SIDE, side, SIDE, scratch, size, distances[0]) == VDNA_OK);
    for (uint32_t i = 0; i < SIDE; i++)
        for (uint32_t j = 0; j < SIDE; j++) {
            double mean = -1;
            MUST(vdna_emd_mean(&side[i], &side[j], scratch, size, &mean) == VDNA_OK);
            MUST(memcmp(&mean, &distances[i][j], sizeof mean) == 0);
        }
    free(scratch);
}

static void compare(calls *c, machine *m)
{
    const counted *live = a_hist(c, m);
    vdna_hist_view views[HISTS], p;
    vdna_rank_entry ranking[HISTS];
    uint32_t count = 0;
    if (!live)
        return;
    vdna_hist_view_of(&live->hist, &p);
    for (size_t i = 0; i < HISTS; i++)
        if (m->hists[i].mem) {
            vdna_hist_view_of(&m->hists[i].hist, &views[count]);
            check_distance(&p, &views[count++]);
        }
    const size_t size = vdna_emd_scratch_size(p.neurons);
    void *scratch = block_of(size);
    if (vdna_rank(&p, views, count, scratch, size, ranking) == VDNA_OK) {
        check_ranking(ranking, count);
        check_top(&p, views, count, below(c, HISTS + 2), ranking);
        check_block(views, count);
    }
    free(scratch);
}

static void sort(calls *c, machine *m)
{
    (void)m;
    enum { COUNT = 8 };
    vdna_rank_entry ranking[COUNT];
    const uint32_t count = below(c, COUNT);
    double *distances = doubles_of(c, count);
    int is_finite = 1;
    for (uint32_t i = 0; i < count; i++)
        is_finite &= isfinite(distances[i]) != 0;
    const vdna_status status = vdna_rank_sort(distances, count, ranking);
    MUST(status == (count == 0 ? VDNA_ERR_ARG : is_finite ? VDNA_OK : VDNA_ERR_NONFINITE));
    if (status == VDNA_OK)
        check_ranking(ranking, count);
    free(distances);
}

/* ---- reasons */

static int all_finite_numbers(const double *numbers, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        if (!isfinite(numbers[i]))
            return 0;
    return 1;
}

static void check_reasons(const vdna_reason *top, uint32_t wanted)
{
    uint32_t found = 0;
    for (uint32_t i = 0; i < wanted; i++) {
        MUST(top[i].count == 1 && (found & 1u << top[i].neuron) == 0);
        found |= 1u << top[i].neuron;
        MUST(i == 0 || fabs(top[i].margin_bins) <= fabs(top[i - 1].margin_bins));
    }
}

static void explain(calls *c, machine *m)
{
    (void)m;
    enum { COUNT = 8 };
    const uint32_t neurons = below(c, COUNT), wanted = below(c, COUNT + 1);
    double *winner = doubles_of(c, neurons), *against = doubles_of(c, neurons);
    vdna_reason *top = block_of(wanted * sizeof *top), sum = {0, 0, 0, 0, 0};
    const int finite = all_finite_numbers(winner, neurons) && all_finite_numbers(against, neurons);
    const vdna_status status = vdna_explain_top(winner, against, neurons, wanted, top);
    MUST(status == (wanted == 0 || wanted > neurons ? VDNA_ERR_ARG
                    : finite                        ? VDNA_OK
                                                    : VDNA_ERR_NONFINITE));
    if (status == VDNA_OK)
        check_reasons(top, wanted);
    const uint32_t first = any_count(c, 0), count = any_count(c, 0);
    const int is_inside = count > 0 && (uint64_t)first + count <= neurons;
    MUST((vdna_explain_sum(winner, against, neurons, first, count, &sum) == VDNA_OK) == is_inside);
    MUST(sum.count == (is_inside ? count : 0));
    free(winner);
    free(against);
    free(top);
}

static void find_example_frames(calls *c, machine *m)
{
    (void)m;
    enum { FRAMES = 6, DIM = 3 };
    const uint32_t frames = below(c, FRAMES), dim = below(c, DIM), neuron = below(c, DIM);
    int8_t *codes = block_of((size_t)frames * dim);
    float *scale = floats_of(c, frames);
    uint32_t most = UINT32_MAX, least = UINT32_MAX;
    for (size_t i = 0; i < (size_t)frames * dim; i++)
        codes[i] = (int8_t)next_byte(c);
    const int is_inside = frames > 0 && neuron < dim;
    MUST((vdna_explain_frames(codes, scale, frames, dim, neuron, &most, &least) == VDNA_OK) ==
         is_inside);
    MUST(is_inside ? most < frames && least < frames : most == UINT32_MAX && least == UINT32_MAX);
    free(codes);
    free(scale);
}

/* ---- windows */

static void make_window(calls *c, machine *m)
{
    counted *x = &m->windows[below(c, WINDOWS)];
    drop(x);
    x->tap_count = any_shape(c, x->shape);
    vdna_window_config config;
    vdna_window_config_init_sized(&config, sizeof config - seldom(c, 16));
    config.capacity = x->capacity = any_count(c, 1);
    config.length_us = seldom(c, 32) ? any_int64(c) : below(c, 4);
    config.taps = seldom(c, 64) ? NULL : x->shape;
    config.tap_count = x->tap_count;
    config.range = a_range(c, m);
    config.bins = any_count(c, VDNA_HIST_BINS_MIN);
    config.which = x->which = seldom(c, 32) ? next_byte(c) : below(c, 2);
    config.least_frames = seldom(c, 4) ? below(c, 8) : 0;
    const size_t size = vdna_window_mem_size(&config);
    if (size == 0 || size > SIZE_TRIED)
        return;
    const size_t given = size - seldom(c, 16);
    x->mem = block_of(given);
    const vdna_status status = vdna_window_init(&config, x->mem, given, &x->window);
    MUST(status == (given < size ? VDNA_ERR_NOMEM : VDNA_OK));
    if (status != VDNA_OK)
        drop(x);
}

static void check_window(counted *x)
{
    const vdna_hist *hist = vdna_window_hist(x->window);
    const double progress = vdna_window_progress(x->window);
    MUST(progress >= 0 && progress <= 1);
    MUST(hist->frames <= x->capacity);
    MUST(vdna_window_first_utime(x->window) <= vdna_window_last_utime(x->window));
    MUST(vdna_window_truncated(x->window) <= 1);
    /* All frames of a sliding window have its shape, so its mass follows from their number. */
    if (x->which == VDNA_WINDOW_LAST) {
        memset(x->mass, 0, sizeof x->mass);
        frame one = {{{0}}, x->tap_count, NULL};
        memcpy(one.taps, x->shape, sizeof one.taps);
        add_mass(x->mass, &one);
        for (size_t n = 0; n < NEURONS; n++)
            x->mass[n] *= hist->frames;
    }
    check_hist(hist, x->mass);
}

static void offer(calls *c, machine *m)
{
    counted *x = &m->windows[below(c, WINDOWS)];
    if (!x->mem)
        return;
    vdna_activations other[TAPS];
    const uint32_t is_other = seldom(c, 8);
    const size_t tap_count = is_other ? any_shape(c, other) : x->tap_count;
    const frame f = frame_of(c, is_other ? other : x->shape, tap_count);
    const int64_t last = vdna_window_last_utime(x->window);
    const int64_t utime = seldom(c, 32) || last > INT64_MAX / 2 || last < INT64_MIN / 2
                              ? any_int64(c)
                              : last + below(c, 4) - (seldom(c, 8) ? 2 : 0);
    const vdna_hist *hist = vdna_window_hist(x->window);
    const uint64_t restarts = vdna_window_restarts(x->window);
    const snapshot before = snapshot_of(hist->counts, (size_t)hist->bins * hist->neurons * 4);
    uint32_t events = UINT32_MAX;
    const vdna_status status = vdna_window_add(x->window, utime, f.taps, tap_count, &events);
    require_unchanged_on_error(before, status);
    MUST((status == VDNA_OK) == (events <= 7));
    MUST(status != VDNA_OK || vdna_activations_check(f.taps, tap_count, hist->neurons) == 0);
    if (status == VDNA_OK) {
        if (events & VDNA_WINDOW_RESTARTED)
            memset(x->mass, 0, sizeof x->mass);
        if (events & VDNA_WINDOW_ADDED)
            add_mass(x->mass, &f);
        MUST(vdna_window_restarts(x->window) ==
             restarts + (events & VDNA_WINDOW_RESTARTED ? 1 : 0));
        MUST(!(events & VDNA_WINDOW_ADDED) || vdna_window_last_utime(x->window) == utime);
    }
    check_window(x);
    free(f.values);
}

static void reset_window(calls *c, machine *m)
{
    counted *x = &m->windows[below(c, WINDOWS)];
    if (!x->mem)
        return;
    vdna_window_reset(x->window);
    memset(x->mass, 0, sizeof x->mass);
    MUST(vdna_window_hist(x->window)->frames == 0 && vdna_window_progress(x->window) == 0);
    MUST(vdna_window_left_utime(x->window) == 0 || vdna_window_left_early(x->window) > 0);
}

/* ---- embeddings */

static void nearest(calls *c, machine *m)
{
    (void)m;
    enum { ROWS = 6, DIM = 20 };
    const uint32_t dim = below(c, DIM), rows = below(c, ROWS), k = below(c, ROWS + 2);
    const uint32_t written = k < rows ? k : rows;
    float *query = floats_of(c, dim), *map = floats_of(c, (size_t)rows * dim);
    vdna_knn_match *matches = block_of(written * sizeof *matches);
    const vdna_status status = vdna_knn(query, dim, map, rows, k, matches);
    MUST((status == VDNA_ERR_ARG) == (dim == 0 || written == 0));
    MUST(status != VDNA_OK || (all_finite(query, dim) && all_finite(map, (size_t)rows * dim)));
    for (uint32_t i = 0; i < written && status == VDNA_OK; i++) {
        MUST(matches[i].index < rows && matches[i].distance_sq >= 0);
        MUST(i == 0 || matches[i - 1].distance_sq < matches[i].distance_sq ||
             (matches[i - 1].distance_sq == matches[i].distance_sq &&
              matches[i - 1].index < matches[i].index));
    }
    free(query);
    free(map);
    free(matches);
}

static void nearest_by_codes(calls *c, machine *m)
{
    (void)m;
    enum { ROWS = 40, DIM = 20 };
    const uint32_t dim = below(c, DIM), rows = below(c, ROWS);
    float *query = floats_of(c, dim), *map = floats_of(c, (size_t)rows * dim);
    const size_t size = vdna_knn_codes_size(dim, rows);
    MUST((size == 0) == (dim == 0 || rows == 0));
    double *codes = block_of(size);
    if (vdna_knn_encode(map, dim, rows, codes, size) == VDNA_OK) {
        vdna_knn_match by_codes, without;
        const vdna_status status = vdna_knn(query, dim, map, rows, 1, &without);
        MUST(vdna_knn_nearest(query, dim, map, rows, codes, &by_codes) == status);
        MUST(status != VDNA_OK || memcmp(&by_codes, &without, sizeof without) == 0);
    }
    free(query);
    free(map);
    free(codes);
}

static void encode(calls *c, machine *m)
{
    (void)m;
    enum { COUNT = 20 };
    const size_t count = below(c, COUNT);
    float *values = floats_of(c, count), *decoded = block_of(count * sizeof *decoded);
    int8_t *codes = block_of(count);
    float scale = -1;
    const vdna_status status = vdna_int8_encode(values, count, codes, &scale);
    MUST(status == (count == 0                  ? VDNA_ERR_ARG
                    : all_finite(values, count) ? VDNA_OK
                                                : VDNA_ERR_NONFINITE));
    MUST((scale == -1) == (status != VDNA_OK));
    if (status == VDNA_OK) {
        MUST(scale >= 0 && vdna_int8_decode(codes, count, scale, decoded) == VDNA_OK);
        for (size_t i = 0; i < count; i++)
            MUST(codes[i] >= -127 &&
                 fabs((double)decoded[i] - values[i]) <= 0.50001 * scale + 127 * 1.5e-45);
    }
    free(values);
    free(decoded);
    free(codes);
}

/* ---- time */

static void begin_time(calls *c, machine *m)
{
    vdna_camera_time_init(&m->time, below(c, 6), seldom(c, 8) ? any_int64(c) : below(c, 4));
}

static void take_stamp(calls *c, machine *m)
{
    static const int64_t units[] = {1, 1000, 1000000, 1700000000000000};
    vdna_camera_time *time = &m->time;
    if (seldom(c, 16))
        vdna_camera_time_begin(time);
    const int64_t stamp = seldom(c, 8) ? any_int64(c) : next_byte(c) * units[below(c, 4)];
    const vdna_camera_time before = *time;
    int64_t utime = 0;
    const uint32_t what = vdna_camera_time_take(time, stamp, &utime);
    MUST(what <= VDNA_TIME_RECOGNISED && time->distinct_count <= VDNA_TIME_DISTINCT_MAX);
    MUST(time->late - before.late == (what == VDNA_TIME_LATE));
    MUST(time->backwards - before.backwards == (what == VDNA_TIME_BACKWARDS));
    MUST(time->frames == (what == VDNA_TIME_IN_ORDER ? before.frames + 1
                          : what == VDNA_TIME_LATE   ? before.frames
                                                     : 1));
    if (what == VDNA_TIME_LATE)
        MUST(utime < time->newest_us && time->newest_us == before.newest_us);
    else
        MUST(utime == time->newest_us && time->before_us <= time->newest_us);
}

static void texts(calls *c, machine *m)
{
    (void)m;
    const uint32_t any = any_count(c, 10);
    MUST(vdna_status_text((vdna_status)any)[0] != '\0');
    MUST(vdna_time_unit_name(any)[0] != '\0');
}

static void recognise(calls *c, machine *m)
{
    (void)m;
    enum { COUNT = 12 };
    int64_t stamps[COUNT];
    const size_t count = below(c, COUNT);
    for (size_t i = 0; i < count; i++)
        stamps[i] = any_int64(c);
    const uint32_t unit = vdna_time_unit(stamps, count);
    MUST(unit <= VDNA_TIME_UNIT_S && vdna_time_unit_name(unit)[0] != '\0');
    for (size_t i = 1; i < count; i++)
        MUST((vdna_time_us(unit, stamps[0]) < vdna_time_us(unit, stamps[i])) <=
             (stamps[0] < stamps[i]));
}

/* ---- the program */

static void (*const operations[])(calls *, machine *) = {observe,    expand,
                                                         make_hist,  add,
                                                         add,        merge_or_subtract,
                                                         reset_hist, compare,
                                                         sort,       make_window,
                                                         offer,      offer,
                                                         offer,      reset_window,
                                                         nearest,    nearest_by_codes,
                                                         encode,     begin_time,
                                                         take_stamp, take_stamp,
                                                         recognise,  texts,
                                                         explain,    find_example_frames};

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    calls c = {bytes, bytes + size};
    machine m;
    memset(&m, 0, sizeof m);
    make_ranges(&c, &m);
    vdna_camera_time_init(&m.time, VDNA_TIME_UNIT_AUTO, VDNA_TIME_LATE_US_DEFAULT);
    for (size_t left = CALLS; left > 0 && has_more(&c); left--) {
        operations[below(&c, sizeof operations / sizeof *operations)](&c, &m);
        for (size_t i = 0; i < HISTS; i++)
            if (m.hists[i].mem) {
                check_hist(&m.hists[i].hist, m.hists[i].mass);
                MUST(m.hists[i].hist.frames == m.hists[i].frames);
            }
    }
    for (size_t i = 0; i < HISTS; i++)
        drop(&m.hists[i]);
    for (size_t i = 0; i < WINDOWS; i++)
        drop(&m.windows[i]);
    return 0;
}

size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity)
{
    return index < 16 && capacity >= PROGRAM ? random_program(index, out) : 0;
}
