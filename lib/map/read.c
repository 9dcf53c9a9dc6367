#include "read.h"

#include <fail.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <vdna/int8.h>

#include "layout.h"
#include "position_frame.h"
#include "rules.h"

static vdna_status read_precision(const vdna_header *header, vdna_error *reason, vdna_experience *e)
{
    if (vdna_header_text(header, "precision"))
        return vdna_tensors_text(header, "precision", e->identity.precision,
                                 sizeof e->identity.precision, reason);
    memcpy(e->identity.precision, VDNA_PRECISION_DEFAULT, sizeof VDNA_PRECISION_DEFAULT);
    return VDNA_OK;
}

/* Read a text that is "" in files without it. */
static vdna_status read_optional(const vdna_header *header, const char *key, char *out,
                                 size_t capacity, vdna_error *reason)
{
    out[0] = '\0';
    return vdna_header_text(header, key) ? vdna_tensors_text(header, key, out, capacity, reason)
                                         : VDNA_OK;
}

static vdna_status read_texts(const vdna_header *header, vdna_error *reason, vdna_experience *e)
{
    const struct {
        const char *key;
        char *out;
        size_t capacity;
    } texts[] = {
        {"name", e->name, sizeof e->name},
        {"backbone", e->identity.backbone, sizeof e->identity.backbone},
        {"model_sha256", e->identity.model_sha256, sizeof e->identity.model_sha256},
        {"preprocessing", e->identity.preprocessing, sizeof e->identity.preprocessing},
        {"taps", e->identity.taps, sizeof e->identity.taps},
        {"comparable", e->comparable, sizeof e->comparable},
    };
    for (size_t t = 0; t < sizeof texts / sizeof *texts; t++) {
        const vdna_status status =
            vdna_tensors_text(header, texts[t].key, texts[t].out, texts[t].capacity, reason);
        if (status != VDNA_OK)
            return status;
    }
    vdna_status status = read_precision(header, reason, e);
    if (status == VDNA_OK)
        status = read_optional(header, "position_frame", e->position_frame,
                               sizeof e->position_frame, reason);
    if (status == VDNA_OK)
        status = read_optional(header, "order", e->order, sizeof e->order, reason);
    if (status == VDNA_OK)
        status = read_optional(header, "embedding", e->identity.embedding,
                               sizeof e->identity.embedding, reason);
    if (status == VDNA_OK)
        status = read_optional(header, "source", e->source, sizeof e->source, reason);
    return status;
}

/* Take two of the experience's sizes from a tensor that has both. */
static vdna_status read_sizes(const vdna_header *header, const char *name, vdna_error *reason,
                              uint32_t *out_rows, uint32_t *out_columns)
{
    const vdna_tensor *tensor = vdna_header_tensor(header, name);
    if (!tensor)
        return vdna_fail(reason, VDNA_ERR_FORMAT, "tensor %s is missing", name);
    const uint64_t *shape = tensor->shape;
    if (tensor->dimensions != 2 || shape[0] == 0 || shape[0] > UINT32_MAX || shape[1] == 0 ||
        shape[1] > UINT32_MAX)
        return vdna_fail(reason, VDNA_ERR_FORMAT,
                         "tensor %s has a shape that does not fit, expected two sizes of at least"
                         " 1 and below 2^32",
                         name);
    *out_rows = (uint32_t)shape[0];
    *out_columns = (uint32_t)shape[1];
    return VDNA_OK;
}

/* The tensor that has a number for each frame and dimension. */
static const char *embeddings_of(const vdna_header *header)
{
    return vdna_header_tensor(header, "frame_embedding") ? "frame_embedding" : "embeddings";
}

static vdna_status read_last_layer_size(const vdna_header *header, vdna_error *reason,
                                        vdna_experience *e)
{
    uint32_t rows; /* find_fields() compares them with the frames */
    if (!vdna_header_tensor(header, "frame_last_layer"))
        return VDNA_OK;
    return read_sizes(header, "frame_last_layer", reason, &rows, &e->last_layer_dim);
}

static vdna_status read_raw_dim(const vdna_header *header, vdna_error *reason, vdna_experience *e)
{
    uint32_t rows; /* find_fields() compares them with the numbers kept */
    if (!vdna_header_tensor(header, "projection"))
        return VDNA_OK;
    return read_sizes(header, "projection", reason, &rows, &e->identity.raw_dim);
}

static vdna_status read_thumbnail_bytes(const vdna_header *header, vdna_error *reason,
                                        vdna_experience *e)
{
    const vdna_tensor *tensor = vdna_header_tensor(header, "thumbnails");
    if (!tensor)
        return VDNA_OK;
    if (tensor->dimensions != 1 || tensor->shape[0] == 0 || tensor->shape[0] > UINT32_MAX)
        return vdna_fail(reason, VDNA_ERR_FORMAT,
                         "tensor thumbnails has a shape that does not fit, expected one size of at"
                         " least 1 and below 2^32");
    e->thumbnail_bytes = (uint32_t)tensor->shape[0];
    return VDNA_OK;
}

static vdna_status find_fields(const unsigned char *bytes, const vdna_header *header,
                               const vdna_experience *e, vdna_error *reason,
                               vdna_field fields[VDNA_FIELD_COUNT])
{
    vdna_layout_of(e, fields); /* vdna_rules_check() knows which ones may be absent */
    return vdna_tensors_find(bytes, header, fields, VDNA_FIELD_COUNT, reason);
}

static vdna_status read_all_sizes(const vdna_header *header, vdna_error *reason, vdna_experience *e)
{
    vdna_status status =
        read_sizes(header, "counts", reason, &e->identity.bins, &e->identity.neurons);
    if (status == VDNA_OK)
        status = read_sizes(header, embeddings_of(header), reason, &e->frames, &e->identity.dim);
    if (status == VDNA_OK)
        status = read_last_layer_size(header, reason, e);
    if (status == VDNA_OK)
        status = read_raw_dim(header, reason, e);
    return status == VDNA_OK ? read_thumbnail_bytes(header, reason, e) : status;
}

static vdna_status read_tensors(const unsigned char *bytes, const vdna_header *header,
                                vdna_error *reason, vdna_experience *e)
{
    vdna_field fields[VDNA_FIELD_COUNT];
    vdna_status status = read_all_sizes(header, reason, e);
    if (status == VDNA_OK)
        status = find_fields(bytes, header, e, reason, fields);
    if (status != VDNA_OK)
        return status;

    e->frame_utime = fields[VDNA_FIELD_UTIME].data;
    e->frame_place = fields[VDNA_FIELD_PLACE].data;
    e->frame_position = fields[VDNA_FIELD_POSITION].data;
    e->counts = fields[VDNA_FIELD_COUNTS].data;
    e->mass = fields[VDNA_FIELD_MASS].data;
    e->identity.range = fields[VDNA_FIELD_RANGE].data;
    e->identity.projection = fields[VDNA_FIELD_PROJECTION].data;
    e->embeddings = fields[VDNA_FIELD_EMBEDDINGS].data;
    e->frame_grey = fields[VDNA_FIELD_GREY].data;
    e->last_layer_scale = fields[VDNA_FIELD_LAST_LAYER_SCALE].data;
    e->last_layer = fields[VDNA_FIELD_LAST_LAYER].data;
    e->embedding_scale = fields[VDNA_FIELD_EMBEDDING_SCALE].data;
    e->embedding_codes = fields[VDNA_FIELD_EMBEDDING_CODES].data;
    e->thumbnail_end = fields[VDNA_FIELD_THUMBNAIL_END].data;
    e->thumbnails = fields[VDNA_FIELD_THUMBNAILS].data;
    return VDNA_OK;
}

/* Decode embeddings that are stored as codes, if that is wanted; without their scales,
 * vdna_rules_check() says so. */
static vdna_status take_embeddings(vdna_read_how how, vdna_error *reason, vdna_experience *e)
{
    if (!e->embedding_codes)
        return VDNA_OK;
    e->embeddings = NULL;
    if (!e->embedding_scale || how == VDNA_READ_IN_PLACE)
        return VDNA_OK;
    /* The codes are in the file, so their number is a size in memory; four times it may not be. */
    const size_t dim = e->identity.dim, count = e->frames * dim;
    float *const decoded =
        count <= SIZE_MAX / sizeof *decoded ? malloc(count * sizeof *decoded) : NULL;
    if (!decoded)
        return vdna_fail(reason, VDNA_ERR_NOMEM,
                         "no memory for %zu decoded embeddings of %zu numbers", (size_t)e->frames,
                         dim);
    for (size_t f = 0; f < e->frames; f++)
        vdna_int8_decode(e->embedding_codes + f * dim, dim, e->embedding_scale[f],
                         decoded + f * dim);
    e->embeddings = decoded;
    return VDNA_OK;
}

static vdna_status check_comparable(const vdna_experience *e, vdna_error *reason)
{
    char sha256[VDNA_SHA256_SIZE] = "";
    vdna_identity_hash(&e->identity, sha256); /* cannot fail: vdna_rules_check() passed */
    if (strcmp(sha256, e->comparable) != 0)
        return vdna_fail(reason, VDNA_ERR_FORMAT,
                         "comparable is not the SHA-256 of the other fields, which is %s", sha256);
    return VDNA_OK;
}

static vdna_status finish(vdna_error *reason, vdna_experience *e)
{
    if (vdna_rules_check(e, reason) != VDNA_OK)
        return VDNA_ERR_FORMAT;
    const char *const frame = vdna_position_frame_of(e); /* perhaps its own */
    memmove(e->position_frame, frame, strlen(frame) + 1);
    return check_comparable(e, reason);
}

/* see read.h */
const char *vdna_read_remedy(vdna_status status)
{
    switch (status) {
    case VDNA_ERR_CHECKSUM:
        return "copy it again from its source, or rebuild it with `vdna build`";
    case VDNA_ERR_UNSUPPORTED:
        return "update this program, or rebuild the file with its own `vdna build`";
    case VDNA_ERR_NOMEM:
        return "free some";
    default:
        return "rebuild it with `vdna build`";
    }
}

void vdna_read_free(const vdna_experience *experience)
{
    /* The cast drops const, which is for callers: these floats are in nobody's file. */
    if (experience->embedding_codes)
        free((void *)experience->embeddings);
}

static const vdna_format experience_format = {VDNA_EXPERIENCE_FORMAT, VDNA_MAP_FORMAT};

/* see read.h */
vdna_status vdna_read_header(const unsigned char *bytes, size_t size, vdna_error *reason,
                             vdna_experience *out_experience)
{
    vdna_header header;
    vdna_experience e = {.file_bytes = NULL};
    vdna_status status = vdna_tensors_header(bytes, size, &experience_format, reason, &header);
    if (status == VDNA_OK)
        status = read_texts(&header, reason, &e);
    if (status == VDNA_OK)
        status = read_all_sizes(&header, reason, &e);
    if (status != VDNA_OK)
        return status;
    if (!vdna_header_tensor(&header, "frame_position"))
        e.position_frame[0] = '\0';
    if (vdna_rules_check_header(&e, reason) != VDNA_OK)
        return VDNA_ERR_FORMAT;
    *out_experience = e;
    return VDNA_OK;
}

vdna_status vdna_read(const unsigned char *bytes, size_t size, vdna_read_how how,
                      vdna_error *reason, vdna_experience *out_experience)
{
    vdna_header header;
    vdna_experience e = {.file_bytes = NULL};
    vdna_status status =
        vdna_tensors_read(bytes, size, &experience_format, reason, &header, &e.checksum);
    if (status == VDNA_OK)
        status = read_texts(&header, reason, &e);
    if (status == VDNA_OK)
        status = read_tensors(bytes, &header, reason, &e);
    if (status == VDNA_OK)
        status = take_embeddings(how, reason, &e);
    if (status == VDNA_OK)
        status = finish(reason, &e);
    if (status == VDNA_OK)
        *out_experience = e;
    else
        vdna_read_free(&e);
    return status;
}
