/* The shape of a frame: the total over its taps. Private to the core. */
#ifndef VDNA_CORE_SHAPE_H
#define VDNA_CORE_SHAPE_H

#include <vdna/activation.h>

/* Check the fields of each tap but not `values`, and add up.
 * @param out_neurons  of all taps
 * @return VDNA_OK; VDNA_ERR_ARG for a bad field or a tap too large for memory; VDNA_ERR_MISMATCH if
 *         the neurons pass UINT32_MAX */
vdna_status vdna_taps_shape(const vdna_activations *taps, size_t tap_count, uint32_t *out_neurons);

#endif
