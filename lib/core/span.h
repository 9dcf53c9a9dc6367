/* What distances and their bounds share: neurons that are summed alike, and the division of their
 * sums. Private to the core. */
#ifndef VDNA_CORE_SPAN_H
#define VDNA_CORE_SPAN_H

#include <vdna/hist.h>

/* Neighbouring neurons with the same two masses, such as those of one tap. Scaled to the least
 * common multiple of both masses, their cumulative histograms are whole numbers. */
typedef struct vdna_span {
    size_t first, count;       /* neurons */
    uint32_t scale_p, scale_q; /* factors for the counts of P and Q */
    uint64_t mass;             /* the common multiple */
} vdna_span;

/* The span that begins with neuron `first`.
 * @param mass_p, mass_q  [neurons], none 0 */
vdna_span vdna_span_from(const uint32_t *mass_p, const uint32_t *mass_q, size_t neurons,
                         size_t first);

/* sum / mass, rounded once, to nearest; mass is 1..2^63 - 1. Of two sums the larger has no smaller
 * quotient. */
double vdna_quotient(uint64_t sum, uint64_t mass);

/* Check that the scratch is aligned for int64_t and has vdna_emd_scratch_size().
 * @return VDNA_OK, VDNA_ERR_ARG or VDNA_ERR_NOMEM */
vdna_status vdna_check_scratch(uint32_t neurons, const void *scratch, size_t scratch_size);

/* Check that two views compare, and the scratch.
 * @return as vdna_emd(), but for VDNA_ERR_OVERFLOW */
vdna_status vdna_check_pair(const vdna_hist_view *p, const vdna_hist_view *q, const void *scratch,
                            size_t scratch_size);

#endif
