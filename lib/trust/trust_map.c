/* What a map tells about itself: distances, windows and cells of its runs. */
#include <math.h>

#include <vdna/knn.h>
#include <vdna/trust.h>

#include "elementary.h"
#include "vectorised.h"

enum { WINDOW_FRAMES_MAX = 40, TAU_BLOCKS = 8 };

static const double relative_max = 2, least_norm = 1e-12, least_scale = 1e-6;

/* ---- Relative distances ---- */

/* @param square  squared distance
 * @param norms   product of the squared lengths */
static double relative_of(double square, double norms)
{
    const double length = vdna_sqrt(norms);
    const double ratio = square / (length > least_norm ? length : least_norm);
    if (!(ratio < relative_max * relative_max))
        return relative_max;
    return vdna_sqrt(ratio);
}

/* Relative distance of two frames. */
static double relative_between(const float *a, const float *b, size_t dim)
{
    double square = 0, of_a = 0, of_b = 0;
    for (size_t i = 0; i < dim; i++) {
        const double x = a[i], y = b[i];
        square += (x - y) * (x - y);
        of_a += x * x;
        of_b += y * y;
    }
    return relative_of(square, of_a * of_b);
}

/* see vdna/trust.h */
vdna_status vdna_trust_nearest_in(const float *embedding, const vdna_trust_run *run,
                                  double *out_relative, uint32_t *out_index)
{
    vdna_knn_match match;
    if (!run || !out_relative)
        return VDNA_ERR_ARG;
    const vdna_status status =
        vdna_knn_nearest(embedding, run->dim, run->embeddings, run->frames, run->codes, &match);
    if (status != VDNA_OK)
        return status;
    *out_relative =
        relative_between(embedding, run->embeddings + (size_t)match.index * run->dim, run->dim);
    if (out_index)
        *out_index = match.index;
    return VDNA_OK;
}

/* see vdna/trust.h */
vdna_status vdna_trust_nearest(const float *embedding, const float *frames, uint32_t dim,
                               uint32_t count, double *out_relative, uint32_t *out_index)
{
    const vdna_trust_run run = {.embeddings = frames, .frames = count, .dim = dim};
    return vdna_trust_nearest_in(embedding, &run, out_relative, out_index);
}

/* Sums of integers do not depend on their order. */
VDNA_VECTORISED static void code_sums(const int8_t *a, const int8_t *b, size_t dim,
                                      int32_t *out_product, int32_t *out_square)
{
    int32_t product = 0, square = 0;
    for (size_t i = 0; i < dim; i++) {
        product += a[i] * b[i];
        square += b[i] * b[i];
    }
    *out_product = product;
    *out_square = square;
}

static int is_scale(float scale)
{
    return isfinite(scale) && scale >= 0;
}

/* see vdna/trust.h */
vdna_status vdna_trust_nearest_int8(const int8_t *codes, float scale, const int8_t *frames,
                                    const float *scales, uint32_t dim, uint32_t count,
                                    double *out_relative)
{
    if (!codes || !frames || !scales || dim == 0 || dim > VDNA_TRUST_CODES_MAX || count == 0 ||
        !out_relative)
        return VDNA_ERR_ARG;
    int32_t product = 0, square = 0;
    code_sums(codes, codes, dim, &product, &square);
    const double length_sq = (double)scale * scale * square;
    double least = INFINITY, norms = 0;
    for (uint32_t f = 0; f < count; f++, frames += dim) {
        if (!is_scale(scale) || !is_scale(scales[f]))
            return VDNA_ERR_NONFINITE;
        code_sums(codes, frames, dim, &product, &square);
        const double of_frame = (double)scales[f] * scales[f] * square;
        const double distance = length_sq + of_frame - 2 * ((double)scale * scales[f] * product);
        if (distance < least) {
            least = distance;
            norms = length_sq * of_frame;
        }
    }
    *out_relative = relative_of(least > 0 ? least : 0, norms);
    return VDNA_OK;
}

/* ---- Places ---- */

static double square_of(double x)
{
    return x * x;
}

/* Squared distance of the places of two frames, in one unit; NaN if there is none. */
static double apart_sq(const vdna_trust_run *a, size_t frame_a, const vdna_trust_run *b,
                       size_t frame_b)
{
    if (a->position && b->position) {
        const double *p = a->position + 3 * frame_a, *q = b->position + 3 * frame_b;
        return square_of(p[0] - q[0]) + square_of(p[1] - q[1]) + square_of(p[2] - q[2]);
    }
    if (!a->place || !b->place)
        return NAN;
    const int64_t p = a->place[frame_a], q = b->place[frame_b];
    if (p == INT64_MIN || q == INT64_MIN)
        return NAN;
    return square_of((double)p - (double)q);
}

static int is_run(const vdna_trust_run *run)
{
    return run && run->frames > 0 && run->dim > 0 && run->dim < UINT32_MAX &&
           run->last_layer_dim <= VDNA_TRUST_CODES_MAX;
}

static int is_tolerance(double tolerance)
{
    return isfinite(tolerance) && tolerance >= 0;
}

/* First frame from `from` on whose place is, or is not, more than two tolerances from that of a
 * frame. */
static uint32_t next_frame(const vdna_trust_run *run, uint32_t frame, double tolerance,
                           uint32_t from, int is_elsewhere)
{
    while (from < run->frames &&
           (apart_sq(run, frame, run, from) > square_of(2 * tolerance)) != is_elsewhere)
        from++;
    return from;
}

/* Relative distance of a frame to the nearest of its run at another place, searched stretch by
 * stretch; NaN if there is none. */
static vdna_status nearest_elsewhere(const vdna_trust_run *run, uint32_t frame, double tolerance,
                                     double *out_relative)
{
    const float *embedding = run->embeddings + (size_t)frame * run->dim;
    vdna_knn_match best = {INFINITY, 0, 0};
    uint32_t begin = next_frame(run, frame, tolerance, 0, 1), end;
    for (; begin < run->frames; begin = next_frame(run, frame, tolerance, end, 1)) {
        end = next_frame(run, frame, tolerance, begin, 0);
        vdna_knn_match match;
        const vdna_status status =
            vdna_knn(embedding, run->dim, run->embeddings + (size_t)begin * run->dim, end - begin,
                     1, &match);
        if (status != VDNA_OK)
            return status;
        if (match.distance_sq < best.distance_sq) {
            best = match;
            best.index += begin;
        }
    }
    *out_relative = NAN;
    if (best.distance_sq < INFINITY)
        *out_relative =
            relative_between(embedding, run->embeddings + (size_t)best.index * run->dim, run->dim);
    return VDNA_OK;
}

/* see vdna/trust.h */
vdna_status vdna_trust_own_scale(const vdna_trust_run *run, double tolerance, double *out_own)
{
    if (!is_run(run) || !run->embeddings || !is_tolerance(tolerance) || !out_own)
        return VDNA_ERR_ARG;
    double sum = 0;
    uint32_t count = 0;
    for (uint32_t f = 0; f < run->frames; f++) {
        double relative;
        const vdna_status status = nearest_elsewhere(run, f, tolerance, &relative);
        if (status != VDNA_OK)
            return status;
        if (isfinite(relative)) {
            sum += relative;
            count++;
        }
    }
    const double mean = count > 0 ? sum / count : 1;
    *out_own = mean > least_scale ? mean : least_scale;
    return VDNA_OK;
}

/* ---- Cells ---- */

/* see vdna/trust.h */
uint32_t vdna_trust_windows(uint32_t frames, uint32_t *out_first, uint32_t *out_frames)
{
    if (frames == 0)
        return 0;
    uint32_t length = frames / 3;
    length = length < 1 ? 1 : length > WINDOW_FRAMES_MAX ? WINDOW_FRAMES_MAX : length;
    uint32_t count = 0, before = 0;
    for (uint32_t i = 0; i < VDNA_TRUST_WINDOWS; i++) {
        const uint32_t first = (uint32_t)(((uint64_t)i * (frames - length) + 3) / 6);
        if (i > 0 && first == before)
            continue;
        if (out_first)
            out_first[count] = first;
        before = first;
        count++;
    }
    if (out_frames)
        *out_frames = length;
    return count;
}

/* Working memory of a pair. */
typedef struct pair_memory {
    double *live_mean, *candidate_mean; /* [dim] */
    float *direction;                   /* [dim + 1], of a live frame */
    float *directions;                  /* [frames][dim + 1], of the candidate's */
    int8_t *correct;                    /* [live frames]: 1, 0, or NO_LABEL */
    size_t total;                       /* bytes; 0 = invalid */
} pair_memory;

enum { NO_LABEL = -1 };

/* @param scratch  NULL gives the bytes alone */
static pair_memory memory_of_pair(const vdna_trust_run *live, const vdna_trust_run *candidate,
                                  void *scratch)
{
    pair_memory m = {.total = 0};
    if (!is_run(live) || !is_run(candidate))
        return m;
    const size_t dim = live->dim, row = sizeof(float) * (dim + 1);
    const size_t fixed = 2 * dim * sizeof(double) + row + live->frames;
    if (candidate->frames > (SIZE_MAX - fixed) / row)
        return m;
    m.total = fixed + candidate->frames * row;
    if (!scratch)
        return m;
    m.live_mean = scratch;
    m.candidate_mean = m.live_mean + dim;
    m.direction = (float *)(void *)(m.candidate_mean + dim);
    m.directions = m.direction + (dim + 1);
    m.correct = (int8_t *)(m.directions + candidate->frames * (dim + 1));
    return m;
}

/* see vdna/trust.h */
size_t vdna_trust_pair_scratch_size(const vdna_trust_run *live, const vdna_trust_run *candidate)
{
    return memory_of_pair(live, candidate, NULL).total;
}

static void mean_of_run(const vdna_trust_run *run, double *out_mean)
{
    const size_t dim = run->dim;
    for (size_t i = 0; i < dim; i++)
        out_mean[i] = 0;
    for (size_t f = 0; f < run->frames; f++)
        for (size_t i = 0; i < dim; i++)
            out_mean[i] += run->embeddings[f * dim + i];
    for (size_t i = 0; i < dim; i++)
        out_mean[i] /= run->frames;
}

/* Write the direction of a frame from a mean.
 * @return whether it has one */
static int direction_of(const float *frame, const double *mean, size_t dim, float *out)
{
    double sum = 0;
    for (size_t i = 0; i < dim; i++)
        sum += square_of(frame[i] - mean[i]);
    const double length = vdna_sqrt(sum);
    const double scale = 1 / (length > least_norm ? length : least_norm);
    for (size_t i = 0; i < dim; i++)
        out[i] = (float)((frame[i] - mean[i]) * scale);
    return length > least_norm;
}

/* Write the directions of the candidate's frames. The nearest of directions by Euclid is the
 * nearest by angle; one more number sees to that where a frame has no direction: it makes up the
 * length of 1. */
static void directions_of(const vdna_trust_run *candidate, const pair_memory *m)
{
    const size_t dim = candidate->dim;
    float *row = m->directions;
    for (size_t f = 0; f < candidate->frames; f++, row += dim + 1)
        row[dim] =
            direction_of(candidate->embeddings + f * dim, m->candidate_mean, dim, row) ? 0 : 1;
}

/* Row of the candidate's frame at which a live frame is localised: of equals the first, as all are
 * to a frame without a direction. */
static uint32_t localised_at(const vdna_trust_run *live, const vdna_trust_run *candidate,
                             uint32_t frame, const pair_memory *m)
{
    vdna_knn_match match = {0, 0, 0};
    if (!direction_of(live->embeddings + (size_t)frame * live->dim, m->live_mean, live->dim,
                      m->direction))
        return 0;
    m->direction[live->dim] = 0;
    vdna_knn(m->direction, live->dim + 1, m->directions, candidate->frames, 1, &match);
    return match.index;
}

/* Relative distances of all frames, and whether they are localised correctly. */
static vdna_status compare_frames(const vdna_trust_run *live, const vdna_trust_run *candidate,
                                  double tolerance, uint32_t localiser, const pair_memory *m,
                                  double *out_relative)
{
    const size_t dim = live->dim;
    mean_of_run(live, m->live_mean);
    mean_of_run(candidate, m->candidate_mean);
    directions_of(candidate, m);
    for (uint32_t f = 0; f < live->frames; f++) {
        uint32_t at;
        const vdna_status status =
            vdna_trust_nearest(live->embeddings + f * dim, candidate->embeddings, live->dim,
                               candidate->frames, &out_relative[f], &at);
        if (status != VDNA_OK)
            return status;
        if (localiser == VDNA_TRUST_CENTRED)
            at = localised_at(live, candidate, f, m);
        const double apart = apart_sq(live, f, candidate, at);
        m->correct[f] = apart >= 0 ? apart <= square_of(tolerance) : NO_LABEL;
    }
    return VDNA_OK;
}

static double recall_outside(const int8_t *correct, uint32_t frames, uint32_t first, uint32_t count)
{
    uint32_t good = 0, known = 0;
    for (uint32_t f = 0; f < frames; f++)
        if ((f < first || f >= first + count) && correct[f] != NO_LABEL) {
            good += correct[f] != 0;
            known++;
        }
    return known > 0 ? (double)good / known : NAN;
}

static int has_last_layer(const vdna_trust_run *run)
{
    return run->last_layer && run->last_layer_scale && run->last_layer_dim > 0;
}

static vdna_status window_likeness(const vdna_trust_run *live, const vdna_trust_run *candidate,
                                   uint32_t first, uint32_t count, double *out_mean)
{
    double sum = 0;
    for (size_t f = first; f < (size_t)first + count; f++) {
        double relative;
        const vdna_status status = vdna_trust_nearest_int8(
            live->last_layer + f * live->last_layer_dim, live->last_layer_scale[f],
            candidate->last_layer, candidate->last_layer_scale, live->last_layer_dim,
            candidate->frames, &relative);
        if (status != VDNA_OK)
            return status;
        sum += relative;
    }
    *out_mean = sum / count;
    return VDNA_OK;
}

static double mean_from(const double *values, uint32_t first, uint32_t count)
{
    double sum = 0;
    for (uint32_t i = first; i < first + count; i++)
        sum += values[i];
    return sum / count;
}

/* see vdna/trust.h */
vdna_status vdna_trust_pair(const vdna_trust_run *live, const vdna_trust_run *candidate,
                            double tolerance, uint32_t localiser, void *scratch,
                            size_t scratch_size, double *out_relative, vdna_trust_cell *out_cell)
{
    const pair_memory m = memory_of_pair(live, candidate, scratch);
    if (m.total == 0 || !live->embeddings || !candidate->embeddings || !is_tolerance(tolerance) ||
        localiser > VDNA_TRUST_EUCLIDEAN || !scratch || (uintptr_t)scratch % sizeof(double) != 0 ||
        !out_relative || !out_cell)
        return VDNA_ERR_ARG;
    if (scratch_size < m.total)
        return VDNA_ERR_NOMEM;
    const int has_both = has_last_layer(live) && has_last_layer(candidate);
    if (live->dim != candidate->dim ||
        (has_both && live->last_layer_dim != candidate->last_layer_dim))
        return VDNA_ERR_MISMATCH;

    vdna_status status = compare_frames(live, candidate, tolerance, localiser, &m, out_relative);
    uint32_t first[VDNA_TRUST_WINDOWS] = {0}, length = 0;
    const uint32_t windows = vdna_trust_windows(live->frames, first, &length);
    for (uint32_t i = 0; i < VDNA_TRUST_WINDOWS && status == VDNA_OK; i++) {
        out_cell->nearest[i] = out_cell->likeness[i] = out_cell->recall[i] = NAN;
        out_cell->distance[i] = NAN;
        if (i >= windows)
            continue;
        out_cell->nearest[i] = mean_from(out_relative, first[i], length);
        out_cell->recall[i] = recall_outside(m.correct, live->frames, first[i], length);
        if (has_both)
            status = window_likeness(live, candidate, first[i], length, &out_cell->likeness[i]);
    }
    return status;
}

/* ---- Correlation time ---- */

/* Variance of `count` sums of `length` neighbours each, of the differences of two rows about their
 * means. */
static double variance_of_sums(const double *a, double mean_a, const double *b, double mean_b,
                               uint32_t count, uint32_t length)
{
    double sum = 0, squares = 0;
    for (int pass = 0; pass < 2; pass++) {
        const double mean = pass ? sum / count : 0;
        for (size_t i = 0; i < count; i++) {
            double total = 0;
            for (size_t t = i * length; t < (i + 1) * length; t++)
                total += a[t] / mean_a - b[t] / mean_b;
            sum += pass ? 0 : total;
            squares += pass ? square_of(total - mean) : 0;
        }
    }
    return squares / (count - 1);
}

/* Put a value in its place among sorted ones. */
static void insert_sorted(double *values, size_t count, double value)
{
    for (; count > 0 && values[count - 1] > value; count--)
        values[count] = values[count - 1];
    values[count] = value;
}

/* see vdna/trust.h */
vdna_status vdna_trust_correlation_time(const double *relative, uint32_t candidates,
                                        uint32_t frames, double *scratch, double *out_frames)
{
    if (!relative || candidates > VDNA_TRUST_RUNS_MAX || !scratch || !out_frames)
        return VDNA_ERR_ARG;
    const uint32_t length = frames / TAU_BLOCKS;
    size_t found = 0;
    for (size_t i = 0; i < candidates && length >= 2; i++)
        for (size_t j = 0; j < i; j++) {
            const double *a = relative + i * frames, *b = relative + j * frames;
            const double mean_a = mean_from(a, 0, frames), mean_b = mean_from(b, 0, frames);
            const double variance = variance_of_sums(a, mean_a, b, mean_b, frames, 1);
            const double of_blocks = variance_of_sums(a, mean_a, b, mean_b, TAU_BLOCKS, length);
            if (variance > 0)
                insert_sorted(scratch, found++, of_blocks / length / variance);
        }
    *out_frames = found > 0 ? (scratch[(found - 1) / 2] + scratch[found / 2]) / 2 : NAN;
    return VDNA_OK;
}
