/* The prepared frames of an experience. Private to lib/localise. */
#ifndef VDNA_LOCALISE_LOCALISE_MAP_H
#define VDNA_LOCALISE_LOCALISE_MAP_H

#include <vdna/localise.h>

/* At the beginning of the caller's block; mean and rows follow. */
struct vdna_localise_map {
    double *mean;  /* [dim] */
    int16_t *rows; /* [frames][stride], directions as vdna_take_direction() writes them */
    double step;
    size_t stride; /* dim, rounded up to an even number */
    uint32_t frames, dim, centred;
};

/* What a direction's length of 1 is as an integer. The product of two directions is at most its
 * square, in whatever order the products of their numbers are added up, and so fits 32 bits. */
#define VDNA_DIRECTION_LENGTH 32767.0

/* Write the direction of a frame from the map's or the live mean, rounded to integers.
 * @param out  [stride] */
void vdna_take_direction(const vdna_localise_map *map, const float *frame, const double *mean,
                         int16_t *out);

/* Whether all numbers are finite. */
int vdna_all_finite(const float *values, size_t count);

#endif
