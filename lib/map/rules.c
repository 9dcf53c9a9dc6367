#include "rules.h"

#include <fail.h>
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include <vdna/int8.h>

#include "layout.h"
#include "position_frame.h"

/* Neurons whose counts are added up at a time: their sums take 8 kB of stack. */
#define SUM_BLOCK 1024u

/* Numbers of an embedding that are decoded at a time. */
#define DECODE_BLOCK 256u

static vdna_status check_name(const vdna_experience *e, vdna_error *reason)
{
    vdna_error why;
    if (vdna_name_check(e->name, &why) != VDNA_OK)
        return vdna_fail(reason, VDNA_ERR_ARG, "name %s", why.text);
    return VDNA_OK;
}

static vdna_status check_shape(const vdna_experience *e, vdna_error *reason)
{
    if (e->identity.neurons == 0 || e->frames == 0 || e->identity.dim == 0 ||
        e->identity.bins < VDNA_HIST_BINS_MIN || e->identity.bins > VDNA_HIST_BINS_MAX)
        return vdna_fail(reason, VDNA_ERR_ARG,
                         "it has %" PRIu32 " neurons, %" PRIu32 " bins, %" PRIu32
                         " frames and embeddings of %" PRIu32
                         " numbers, expected at least one of each and 2 to 65536 bins",
                         e->identity.neurons, e->identity.bins, e->frames, e->identity.dim);

    vdna_field fields[VDNA_FIELD_COUNT];
    vdna_layout_of(e, fields);
    for (size_t f = 0; f < VDNA_FIELD_COUNT; f++)
        if (!fields[f].data && !fields[f].optional)
            return vdna_fail(reason, VDNA_ERR_ARG, "%s is missing", fields[f].name);
    if (!e->embeddings && !e->embedding_codes)
        return vdna_fail(reason, VDNA_ERR_ARG, "embeddings is missing");
    return VDNA_OK;
}

static vdna_status check_identity(const vdna_experience *e, vdna_error *reason)
{
    return vdna_identity_check(&e->identity, reason);
}

static vdna_status check_scales(const char *field, const float *scales, uint32_t frames,
                                vdna_error *reason)
{
    for (size_t f = 0; scales && f < frames; f++)
        if (!(scales[f] >= 0 && scales[f] <= VDNA_EMBEDDING_MAX / 127))
            return vdna_fail(reason, VDNA_ERR_ARG,
                             "%s of frame %zu is %g, expected a finite number from 0 to %g", field,
                             f, (double)scales[f], (double)(VDNA_EMBEDDING_MAX / 127));
    return VDNA_OK;
}

/* Codes come with scales, and those of the last layer with their number. */
static vdna_status check_codes(const vdna_experience *e, vdna_error *reason)
{
    if (!e->embedding_codes != !e->embedding_scale)
        return vdna_fail(reason, VDNA_ERR_ARG, "%s is missing",
                         e->embedding_codes ? "frame_embedding_scale" : "frame_embedding");
    if (!e->last_layer != !e->last_layer_scale || !e->last_layer != (e->last_layer_dim == 0))
        return vdna_fail(reason, VDNA_ERR_ARG,
                         "the last layer has %s, %s and %" PRIu32
                         " numbers in a frame, expected all of it or nothing",
                         e->last_layer ? "codes" : "no codes",
                         e->last_layer_scale ? "scales" : "no scales", e->last_layer_dim);
    const vdna_status status =
        check_scales("frame_embedding_scale", e->embedding_scale, e->frames, reason);
    return status == VDNA_OK
               ? check_scales("frame_last_layer_scale", e->last_layer_scale, e->frames, reason)
               : status;
}

/* Check the mass of every neuron of a tap; `first` is the first one. */
static vdna_status check_tap_mass(const vdna_experience *e, size_t first, const vdna_tap *t,
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

static vdna_status check_mass(const vdna_experience *e, vdna_error *reason)
{
    size_t first = 0;
    const char *rest = e->identity.taps;
    vdna_tap tap;
    while (vdna_taps_next(&rest, &tap) == VDNA_OK) {
        const vdna_status status = check_tap_mass(e, first, &tap, reason);
        if (status != VDNA_OK)
            return status;
        first += tap.neurons;
    }
    return VDNA_OK;
}

/* Add up the counts of up to SUM_BLOCK neurons; 64-bit sums cannot wrap into a match. It takes
 * whole rows of a block at a time, so that the loop vectorises. */
static void sum_block(const vdna_experience *e, size_t first, size_t count, uint64_t *restrict sums)
{
    memset(sums, 0, count * sizeof *sums);
    for (size_t b = 0; b < e->identity.bins; b++) {
        const uint32_t *restrict row = e->counts + b * e->identity.neurons + first;
        for (size_t n = 0; n < count; n++)
            sums[n] += row[n];
    }
}

static vdna_status check_counts(const vdna_experience *e, vdna_error *reason)
{
    uint64_t sums[SUM_BLOCK];
    for (size_t first = 0; first < e->identity.neurons; first += SUM_BLOCK) {
        const size_t count =
            e->identity.neurons - first < SUM_BLOCK ? e->identity.neurons - first : SUM_BLOCK;
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

/* No early exit, so that the loop vectorises: good numbers are the rule. NaN is not within. */
static int all_within(const float *values, size_t count, float limit)
{
    int within = 1;
    for (size_t i = 0; i < count; i++)
        within &= fabsf(values[i]) <= limit ? 1 : 0;
    return within;
}

static vdna_status check_embedding(const float *values, size_t count, size_t f, vdna_error *reason)
{
    if (all_within(values, count, VDNA_EMBEDDING_MAX))
        return VDNA_OK;
    if (all_within(values, count, FLT_MAX))
        return vdna_fail(reason, VDNA_ERR_ARG,
                         "the embedding of frame %zu has a number beyond %g, by which no frame can"
                         " be localised",
                         f, (double)VDNA_EMBEDDING_MAX);
    return vdna_fail(reason, VDNA_ERR_NONFINITE,
                     "the embedding of frame %zu has a NaN or an infinity", f);
}

/* The embedding of a frame, which may have codes alone: they are decoded a block at a time. */
static vdna_status check_frame_embedding(const vdna_experience *e, size_t f, vdna_error *reason)
{
    const size_t dim = e->identity.dim;
    if (e->embeddings)
        return check_embedding(e->embeddings + f * dim, dim, f, reason);
    float decoded[DECODE_BLOCK];
    vdna_status status = VDNA_OK;
    for (size_t first = 0; first < dim && status == VDNA_OK; first += DECODE_BLOCK) {
        const size_t count = dim - first < DECODE_BLOCK ? dim - first : DECODE_BLOCK;
        vdna_int8_decode(e->embedding_codes + f * dim + first, count, e->embedding_scale[f],
                         decoded);
        status = check_embedding(decoded, count, f, reason);
    }
    return status;
}

static vdna_status check_numbers(const vdna_experience *e, vdna_error *reason)
{
    for (size_t f = 0; f < e->frames; f++) {
        const vdna_status status = check_frame_embedding(e, f, reason);
        if (status != VDNA_OK)
            return status;
        if (!isfinite(e->frame_grey[f]))
            return vdna_fail(reason, VDNA_ERR_NONFINITE,
                             "the grey level of frame %zu is %g, expected 0 to 255", f,
                             (double)e->frame_grey[f]);
        if (e->frame_grey[f] < 0 || e->frame_grey[f] > 255)
            return vdna_fail(reason, VDNA_ERR_ARG,
                             "the grey level of frame %zu is %g, expected 0 to 255", f,
                             (double)e->frame_grey[f]);
    }
    return VDNA_OK;
}

static vdna_status check_order(const vdna_experience *e, vdna_error *reason)
{
    vdna_error why;
    if (!memchr(e->order, '\0', sizeof e->order))
        return vdna_fail(reason, VDNA_ERR_ARG, "order is longer than %u bytes",
                         VDNA_ORDER_SIZE - 1);
    if (e->order[0] != '\0' && vdna_name_check(e->order, &why) != VDNA_OK)
        return vdna_fail(reason, VDNA_ERR_ARG, "order %s", why.text);
    return VDNA_OK;
}

static vdna_status check_source(const vdna_experience *e, vdna_error *reason)
{
    size_t length = 0;
    while (length < sizeof e->source && e->source[length] >= ' ' && e->source[length] <= '~')
        length++;
    if (length < sizeof e->source && e->source[length] == '\0')
        return VDNA_OK;
    return vdna_fail(reason, VDNA_ERR_ARG, "source is not 0 to %u printable ASCII characters",
                     VDNA_SOURCE_SIZE - 1);
}

/* Every thumbnail ends within all of them; what their bytes are does not matter here. */
static vdna_status check_thumbnails(const vdna_experience *e, vdna_error *reason)
{
    if (!e->thumbnails != !e->thumbnail_end || !e->thumbnails != (e->thumbnail_bytes == 0))
        return vdna_fail(reason, VDNA_ERR_ARG,
                         "the thumbnails have %s, %s and %" PRIu32
                         " bytes, expected all of it or nothing",
                         e->thumbnails ? "pictures" : "no pictures",
                         e->thumbnail_end ? "ends" : "no ends", e->thumbnail_bytes);
    if (!e->thumbnails)
        return VDNA_OK;
    uint32_t begin = 0;
    for (size_t f = 0; f < e->frames; f++) {
        const uint32_t end = e->thumbnail_end[f];
        if (end < begin || end - begin > VDNA_THUMBNAIL_MAX)
            return vdna_fail(reason, VDNA_ERR_ARG,
                             "the thumbnail of frame %zu ends at byte %" PRIu32
                             ", expected %" PRIu32 " and at most %u more",
                             f, end, begin, VDNA_THUMBNAIL_MAX);
        begin = end;
    }
    if (begin != e->thumbnail_bytes)
        return vdna_fail(reason, VDNA_ERR_ARG,
                         "the last thumbnail ends at byte %" PRIu32 ", expected %" PRIu32
                         ", the size of all",
                         begin, e->thumbnail_bytes);
    return VDNA_OK;
}

static vdna_status check_frame(const char *frame, vdna_error *reason)
{
    vdna_error why;
    if (vdna_name_check(frame, &why) != VDNA_OK)
        return vdna_fail(reason, VDNA_ERR_ARG, "position_frame %s", why.text);
    return VDNA_OK;
}

static vdna_status check_position_frame(const vdna_experience *e, vdna_error *reason)
{
    return e->frame_position ? check_frame(vdna_position_frame_of(e), reason) : VDNA_OK;
}

/* As a header states it, "" = not. */
static vdna_status check_frame_name(const vdna_experience *e, vdna_error *reason)
{
    return e->position_frame[0] != '\0' ? check_frame(e->position_frame, reason) : VDNA_OK;
}

/* Check one position, which is there. */
static vdna_status check_position(const double *position, size_t f, int is_global,
                                  vdna_error *reason)
{
    for (size_t axis = 0; axis < 3; axis++)
        if (!isfinite(position[axis]))
            return vdna_fail(reason, VDNA_ERR_NONFINITE,
                             "the position of frame %zu has a NaN or an infinity, expected three"
                             " NaNs if it has none",
                             f);
    if (is_global && !vdna_position_is_on_globe(position))
        return vdna_fail(reason, VDNA_ERR_ARG,
                         "the position of frame %zu is not 6.3e6 to 6.5e6 m from the Earth's"
                         " centre, expected Earth-centred metres in position_frame wgs84",
                         f);
    return VDNA_OK;
}

static vdna_status check_positions(const vdna_experience *e, vdna_error *reason)
{
    if (!e->frame_position)
        return VDNA_OK;
    const int is_global = strcmp(vdna_position_frame_of(e), VDNA_FRAME_WGS84) == 0;
    for (size_t f = 0; f < e->frames; f++) {
        const double *const p = e->frame_position + 3 * f;
        if (isnan(p[0]) && isnan(p[1]) && isnan(p[2]))
            continue;
        const vdna_status status = check_position(p, f, is_global, reason);
        if (status != VDNA_OK)
            return status;
    }
    return VDNA_OK;
}

/* A rule. */
typedef vdna_status (*rule)(const vdna_experience *e, vdna_error *reason);

static vdna_status check_rules(const rule *rules, size_t count, const vdna_experience *e,
                               vdna_error *reason)
{
    for (size_t r = 0; r < count; r++) {
        const vdna_status status = rules[r](e, reason);
        if (status != VDNA_OK)
            return status;
    }
    return VDNA_OK;
}

/* see rules.h */
vdna_status vdna_rules_check(const vdna_experience *experience, vdna_error *reason)
{
    static const rule rules[] = {check_name,      check_codes,  check_shape,
                                 check_identity,  check_mass,   check_counts,
                                 check_numbers,   check_order,  check_position_frame,
                                 check_positions, check_source, check_thumbnails};
    return check_rules(rules, sizeof rules / sizeof *rules, experience, reason);
}

/* see rules.h */
vdna_status vdna_rules_check_header(const vdna_experience *header, vdna_error *reason)
{
    static const rule rules[] = {check_name, check_identity, check_order, check_source,
                                 check_frame_name};
    vdna_experience texts = *header;
    texts.identity.raw_dim = 0; /* of a projection, which is a tensor */
    return check_rules(rules, sizeof rules / sizeof *rules, &texts, reason);
}
