#include "rules.h"
#include "layout.h"
#include "precision.h"
#include <fail.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

/* Neurons whose counts are added up at a time: their sums take 8 kB of stack. */
#define SUM_BLOCK 1024u

static int is_hex(char c)
{
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
}

static int is_name(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
           c == '_' || c == '-';
}

/* What every JSON writer writes alike, and without a newline. */
static int is_printable(char c)
{
    return c >= ' ' && c <= '~';
}

/* Check a text in a field of `size` bytes, of which it may be an unterminated abuse. The text
 * itself stays out of the message: it may hold anything. */
static vdna_status check_text(const char *what, const char *text, size_t size, int (*allowed)(char),
                              const char *expected, vdna_error *reason)
{
    size_t i = 0;
    while (i < size && text[i] != '\0' && allowed(text[i]))
        i++;
    if (i > 0 && i < size && text[i] == '\0')
        return VDNA_OK;
    return vdna_fail(reason, VDNA_ERR_ARG, "%s %s, expected 1 to %zu %s", what,
                     i == size         ? "is too long"
                     : text[i] == '\0' ? "is empty"
                                       : "has a character that is not allowed",
                     size - 1, expected);
}

static vdna_status check_sha256(const char *what, const char text[VDNA_MAP_SHA256_SIZE],
                                vdna_error *reason)
{
    for (size_t i = 0; i < VDNA_MAP_SHA256_SIZE; i++)
        if (i == VDNA_MAP_SHA256_SIZE - 1 ? text[i] != '\0' : !is_hex(text[i]))
            return vdna_fail(reason, VDNA_ERR_ARG, "%s is not 64 lower-case hexadecimal digits",
                             what);
    return VDNA_OK;
}

static vdna_status check_texts(const vdna_experience *e, vdna_error *reason)
{
    static const char *const name = "letters, digits, '.', '_' or '-'";
    static const char *const text = "printable ASCII characters";
    vdna_status status = check_text("name", e->name, sizeof e->name, is_name, name, reason);
    if (status == VDNA_OK)
        status = check_text("backbone", e->backbone, sizeof e->backbone, is_name, name, reason);
    if (status == VDNA_OK)
        status = check_text("preprocessing", e->preprocessing, sizeof e->preprocessing,
                            is_printable, text, reason);
    if (status == VDNA_OK && !vdna_precision_is_default(e->precision))
        status = check_text("precision", e->precision, sizeof e->precision, is_name, name, reason);
    if (status == VDNA_OK)
        status = check_text("taps", e->taps, sizeof e->taps, is_printable, text, reason);
    if (status == VDNA_OK)
        status = check_sha256("model_sha256", e->model_sha256, reason);
    return status;
}

static vdna_status check_shape(const vdna_experience *e, vdna_error *reason)
{
    if (e->neurons == 0 || e->frames == 0 || e->dim == 0 || e->bins < VDNA_HIST_BINS_MIN ||
        e->bins > VDNA_HIST_BINS_MAX)
        return vdna_fail(reason, VDNA_ERR_ARG,
                         "it has %" PRIu32 " neurons, %" PRIu32 " bins, %" PRIu32
                         " frames and embeddings of %" PRIu32
                         " numbers, expected at least one of each and 2 to 65536 bins",
                         e->neurons, e->bins, e->frames, e->dim);

    vdna_field fields[VDNA_FIELD_COUNT];
    vdna_layout_of(e, fields);
    for (size_t f = 0; f < VDNA_FIELD_COUNT; f++)
        if (!fields[f].data && !fields[f].optional)
            return vdna_fail(reason, VDNA_ERR_ARG, "%s is missing", fields[f].name);
    return VDNA_OK;
}

/* One "NAME:NEURONS:SAMPLES" of the taps. */
typedef struct tap {
    uint32_t neurons, samples;
} tap;

/* Read the number that ends before `end` and begins after a ':' at or after `begin`.
 * @return where the ':' is; NULL if there is no such number in 1..UINT32_MAX */
static const char *number_before(const char *begin, const char *end, uint32_t *out_number)
{
    uint64_t number = 0, place = 1;
    const char *at = end;
    for (; at > begin && at[-1] >= '0' && at[-1] <= '9' && end - at < 10; at--) {
        number += (uint64_t)(at[-1] - '0') * place;
        place *= 10;
    }
    if (at == begin || at[-1] != ':' || at == end || *at == '0' || number > UINT32_MAX)
        return NULL;
    *out_number = (uint32_t)number;
    return at - 1;
}

/* Read the tap at `text`. The numbers are found from its end: a NAME may hold a ':' itself.
 * @return where it ends; NULL if it is malformed */
static const char *read_tap(const char *text, tap *out_tap)
{
    const char *const end = text + strcspn(text, ",");
    const char *colon = number_before(text, end, &out_tap->samples);
    if (colon)
        colon = number_before(text, colon, &out_tap->neurons);
    return colon && colon > text ? end : NULL;
}

/* Check that every neuron of a tap, the first being `first`, was sampled as often as it says. */
static vdna_status check_tap_mass(const vdna_experience *e, size_t first, const tap *t,
                                  vdna_error *reason)
{
    const uint64_t expected = (uint64_t)e->frames * t->samples;
    for (size_t n = first; n < first + t->neurons; n++)
        if (e->mass[n] != expected)
            return vdna_fail(reason, VDNA_ERR_MISMATCH,
                             "the mass of neuron %zu is %" PRIu32 ", expected %" PRIu64 ": %" PRIu32
                             " frames of %" PRIu32 " samples",
                             n, e->mass[n], expected, e->frames, t->samples);
    return VDNA_OK;
}

static vdna_status check_taps(const vdna_experience *e, vdna_error *reason)
{
    uint64_t neurons = 0;
    for (const char *at = e->taps;; at++) {
        tap t;
        at = read_tap(at, &t);
        if (!at)
            return vdna_fail(reason, VDNA_ERR_ARG,
                             "taps is \"%.200s\", expected NAME:NEURONS:SAMPLES, comma, ...",
                             e->taps);
        if (neurons + t.neurons > e->neurons || (*at == '\0' && neurons + t.neurons < e->neurons))
            return vdna_fail(reason, VDNA_ERR_MISMATCH,
                             "the taps \"%.200s\" do not have the %" PRIu32 " neurons of the"
                             " counts",
                             e->taps, e->neurons);
        const vdna_status status = check_tap_mass(e, (size_t)neurons, &t, reason);
        if (status != VDNA_OK || *at == '\0')
            return status;
        neurons += t.neurons;
    }
}

static vdna_status check_range(const vdna_experience *e, vdna_error *reason)
{
    for (size_t n = 0; n < e->neurons; n++)
        if (vdna_range_check(e->range + 2 * n, 1) != VDNA_OK)
            return vdna_fail(reason, VDNA_ERR_ARG,
                             "the range of neuron %zu is %g..%g, expected finite numbers, the"
                             " first below the second",
                             n, (double)e->range[2 * n], (double)e->range[2 * n + 1]);
    return VDNA_OK;
}

/* Add up the counts of up to SUM_BLOCK neurons; 64-bit sums cannot wrap into a match. Whole rows
 * of a block at a time, so that the loop vectorises. */
static void sum_block(const vdna_experience *e, size_t first, size_t count, uint64_t *restrict sums)
{
    memset(sums, 0, count * sizeof *sums);
    for (size_t b = 0; b < e->bins; b++) {
        const uint32_t *restrict row = e->counts + b * e->neurons + first;
        for (size_t n = 0; n < count; n++)
            sums[n] += row[n];
    }
}

static vdna_status check_counts(const vdna_experience *e, vdna_error *reason)
{
    uint64_t sums[SUM_BLOCK];
    for (size_t first = 0; first < e->neurons; first += SUM_BLOCK) {
        const size_t count = e->neurons - first < SUM_BLOCK ? e->neurons - first : SUM_BLOCK;
        sum_block(e, first, count, sums);
        for (size_t n = 0; n < count; n++)
            if (sums[n] != e->mass[first + n])
                return vdna_fail(reason, VDNA_ERR_MISMATCH,
                                 "the counts of neuron %zu add up to %" PRIu64
                                 ", expected its mass %" PRIu32,
                                 first + n, sums[n], e->mass[first + n]);
    }
    return VDNA_OK;
}

/* Without an early exit, so that the loop vectorises: good numbers are the rule. */
static int all_finite(const float *values, size_t count)
{
    int finite = 1;
    for (size_t i = 0; i < count; i++)
        finite &= isfinite(values[i]) ? 1 : 0;
    return finite;
}

static vdna_status check_numbers(const vdna_experience *e, vdna_error *reason)
{
    for (size_t f = 0; f < e->frames; f++) {
        if (!all_finite(e->embeddings + f * e->dim, e->dim))
            return vdna_fail(reason, VDNA_ERR_NONFINITE,
                             "the embedding of frame %zu has a NaN or an infinity", f);
        if (!isfinite(e->frame_grey[f]))
            return vdna_fail(reason, VDNA_ERR_NONFINITE,
                             "the grey level of frame %zu is %g, expected 0 to 255", f,
                             (double)e->frame_grey[f]);
        if (e->frame_grey[f] < 0 || e->frame_grey[f] > 255)
            return vdna_fail(reason, VDNA_ERR_ARG,
                             "the grey level of frame %zu is %g, expected 0 to 255", f,
                             (double)e->frame_grey[f]);
    }
    for (size_t i = 0; e->frame_position && i < 3 * (size_t)e->frames; i++)
        if (!isfinite(e->frame_position[i]))
            return vdna_fail(reason, VDNA_ERR_NONFINITE,
                             "the position of frame %zu has a NaN or an infinity", i / 3);
    return VDNA_OK;
}

vdna_status vdna_rules_check(const vdna_experience *experience, vdna_error *reason)
{
    static vdna_status (*const checks[])(const vdna_experience *, vdna_error *) = {
        check_texts, check_shape, check_taps, check_range, check_counts, check_numbers};
    for (size_t c = 0; c < sizeof checks / sizeof *checks; c++) {
        const vdna_status status = checks[c](experience, reason);
        if (status != VDNA_OK)
            return status;
    }
    return VDNA_OK;
}
