#include "layout.h"

#include <math.h>
#include <string.h>

void vdna_layout_of(const vdna_experience *experience, vdna_field out_fields[VDNA_FIELD_COUNT])
{
    const vdna_experience *e = experience;
    const float *const floats = e->embedding_codes ? NULL : e->embeddings;
    const vdna_field fields[VDNA_FIELD_COUNT] = {
        {"frame_utime", "I64", 8, 0, {e->frames}, e->frame_utime},
        {"frame_place", "I64", 8, 1, {e->frames}, e->frame_place},
        {"frame_position", "F64", 8, 1, {e->frames, 3}, e->frame_position},
        {"counts", "U32", 4, 0, {e->identity.bins, e->identity.neurons}, e->counts},
        {"mass", "U32", 4, 0, {e->identity.neurons}, e->mass},
        {"range", "F32", 4, 0, {e->identity.neurons, 2}, e->identity.range},
        {"projection", "F32", 4, 1, {e->identity.dim, e->identity.raw_dim}, e->identity.projection},
        {"embeddings", "F32", 4, 1, {e->frames, e->identity.dim}, floats},
        {"frame_grey", "F32", 4, 0, {e->frames}, e->frame_grey},
        {"frame_thumbnail_end", "U32", 4, 1, {e->frames}, e->thumbnail_end},
        {"frame_embedding_scale", "F32", 4, 1, {e->frames}, e->embedding_scale},
        {"frame_last_layer_scale", "F32", 4, 1, {e->frames}, e->last_layer_scale},
        {"frame_embedding", "I8", 1, 1, {e->frames, e->identity.dim}, e->embedding_codes},
        {"frame_last_layer", "I8", 1, 1, {e->frames, e->last_layer_dim}, e->last_layer},
        {"thumbnails", "U8", 1, 1, {e->thumbnail_bytes}, e->thumbnails},
    };
    memcpy(out_fields, fields, sizeof fields);
}

unsigned vdna_layout_version(const vdna_experience *experience)
{
    const vdna_experience *e = experience;
    if (e->identity.projection)
        return 4;
    if (e->identity.embedding[0] != '\0' || e->last_layer || e->embedding_codes)
        return 3;
    for (size_t f = 0; f < e->frames; f++)
        if ((e->frame_place && e->frame_place[f] == VDNA_PLACE_NONE) ||
            (e->frame_position && isnan(e->frame_position[3 * f])))
            return 2;
    return 1;
}
