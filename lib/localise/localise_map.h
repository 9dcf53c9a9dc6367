/* The prepared frames of an experience. Private to lib/localise. */
#ifndef VDNA_LOCALISE_LOCALISE_MAP_H
#define VDNA_LOCALISE_LOCALISE_MAP_H

#include <vdna/localise.h>

/* At the beginning of the caller's block; mean and rows follow. */
struct vdna_localise_map {
    double *mean; /* [dim] */
    float *rows;  /* [frames][dim], at length 1 */
    double step;
    uint32_t frames, dim, centred;
};

/* The factor that brings a vector of this squared length to length 1; shorter ones than 1e-12 stay
 * short. */
double vdna_unit_scale(double length_sq);

/* Whether all numbers are finite. */
int vdna_all_finite(const float *values, size_t count);

#endif
