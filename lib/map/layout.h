/* Private to lib/map: the tensors of an experience file, for its writer and its reader alike. */
#ifndef VDNA_LAYOUT_H
#define VDNA_LAYOUT_H

#include "tensors.h"

/* What the metadata of an experience says about its format. */
#define VDNA_EXPERIENCE_FORMAT "vdna-experience"

/* The order of the tensors in our files: wide elements first, so that each is aligned. */
enum {
    VDNA_FIELD_UTIME,
    VDNA_FIELD_PLACE,
    VDNA_FIELD_POSITION,
    VDNA_FIELD_COUNTS,
    VDNA_FIELD_MASS,
    VDNA_FIELD_RANGE,
    VDNA_FIELD_PROJECTION,
    VDNA_FIELD_EMBEDDINGS,
    VDNA_FIELD_GREY,
    VDNA_FIELD_THUMBNAIL_END,
    VDNA_FIELD_EMBEDDING_SCALE,
    VDNA_FIELD_LAST_LAYER_SCALE,
    VDNA_FIELD_EMBEDDING_CODES,
    VDNA_FIELD_LAST_LAYER,
    VDNA_FIELD_THUMBNAILS, /* last, so that a reader can do without them */
    VDNA_FIELD_COUNT
};

/* The oldest version of the format that allows all of `experience`: 4 for embeddings that are
 * projected, 3 for an embedding of which older readers know nothing, 2 if a frame lacks the ground
 * truth that others have. */
unsigned vdna_layout_version(const vdna_experience *experience);

/* Describe the tensors of `experience`: shapes from its sizes, data from its pointers. */
void vdna_layout_of(const vdna_experience *experience, vdna_field out_fields[VDNA_FIELD_COUNT]);

#endif
