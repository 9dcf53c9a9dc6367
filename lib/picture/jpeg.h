/* Decode JPEG pictures completely or refuse them: left to itself, libjpeg fills the hole in a
 * damaged one with grey and tells only stderr. */
#ifndef VDNA_JPEG_H
#define VDNA_JPEG_H

#include <stddef.h>
#include <stdint.h>

#include "turn.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Room for libjpeg's reason to refuse a picture. */
#define VDNA_JPEG_REASON_MAX 200

/* Does a JPEG picture begin here? 1 or 0. */
int vdna_jpeg_begins(const uint8_t *data, size_t size);

/* A picture as it is stored. */
typedef struct vdna_jpeg_shape {
    uint32_t width, height; /* pixels */
    uint32_t channels;      /* 1 is grey, 3 is colour, 4 are the inks of print */
} vdna_jpeg_shape;

/* Read the shape from the header. Returns 1, or 0 with `reason` filled. */
int vdna_jpeg_shape_of(const uint8_t *data, size_t size, vdna_jpeg_shape *out_shape, char *reason);

/* A side of a picture that is decoded smaller.
 * divisor: 1, 2, 4 or 8 */
static inline uint32_t vdna_jpeg_reduced(uint32_t side, uint32_t divisor)
{
    return side / divisor + (side % divisor != 0);
}

/* Decode into `out_bgr`, packed rows of the picture as `turn` makes it, which was made for the
 * size that vdna_jpeg_shape_of() read from the same bytes, its sides reduced by `divisor`.
 * divisor: 1, 2, 4 or 8; beyond 1, blocks of 8x8 pixels become smaller ones of their low
 * frequencies row: room for one row as it is stored, reduced; used only if `turn` does not keep
 * rows Returns 1, or 0 with `reason` filled. */
int vdna_jpeg_decode(const uint8_t *data, size_t size, uint32_t divisor, const vdna_turn *turn,
                     uint8_t *row, uint8_t *out_bgr, char *reason);

#ifdef __cplusplus
}
#endif

#endif
