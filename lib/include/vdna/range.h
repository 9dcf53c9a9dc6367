/** @file vdna/range.h
 *  @brief Ranges: the outer edges of each neuron's histogram.
 *
 *  A range table is `float[neurons][2]`, lo and hi of each neuron in activation units, exactly as
 *  the `range` tensor of an experience file. It is calibrated once from pictures of the map and
 *  shared by everything that is compared; a live frame never changes it. docs/internals/DESIGN.md
 *  explains each departure from the reference package of Visual DNA.
 */
#ifndef VDNA_RANGE_H
#define VDNA_RANGE_H

#include <vdna/activation.h>

#ifdef __cplusplus
extern "C" {
#endif

/** How vdna_range_expand() widens the observed minimum and maximum. */
enum {
    /** about their midpoint: half-width times `factor`; the default */
    VDNA_RANGE_ABOUT_MIDPOINT = 0,
    /** about zero: lo and hi times `factor`, as the reference package does. It clamps a neuron
     *  whose minimum is positive; kept for comparison only */
    VDNA_RANGE_ABOUT_ZERO = 1
};

/** Factor that leaves a margin around the values seen in calibration. */
#define VDNA_RANGE_FACTOR 1.2f

/** Check that every lo and hi is finite and lo < hi.
 *  @param range  [neurons][2]
 *  @param neurons  >= 1
 *  @return VDNA_OK; VDNA_ERR_ARG */
VDNA_API vdna_status vdna_range_check(const float *range, uint32_t neurons);

/** Forget everything: the table then holds "nothing seen yet" (lo > hi).
 *  @param range  [neurons][2], written
 *  @param neurons  >= 1
 *  @return VDNA_OK; VDNA_ERR_ARG */
VDNA_API vdna_status vdna_range_clear(float *range, uint32_t neurons);

/** Widen the table to contain one frame.
 *  @param range      [neurons][2] after vdna_range_clear() or earlier frames; unchanged on error
 *  @param neurons    of all taps together
 *  @param taps       [tap_count], checked as by vdna_activations_check()
 *  @param tap_count  >= 1
 *  @return VDNA_OK; what vdna_activations_check() returns */
VDNA_API vdna_status vdna_range_observe(float *range, uint32_t neurons,
                                        const vdna_activations *taps, size_t tap_count);

/** Turn an observed table into one to bin with.
 *  A neuron that never varied gets half-width 1 about its value, so that it can vary later.
 *  @param range   [neurons][2], at least one frame observed; unchanged on error
 *  @param neurons >= 1
 *  @param factor  >= 1 and finite, usually VDNA_RANGE_FACTOR
 *  @param rule    VDNA_RANGE_ABOUT_...
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_EMPTY if nothing was observed; VDNA_ERR_NONFINITE if a
 *          widened edge leaves the float range */
VDNA_API vdna_status vdna_range_expand(float *range, uint32_t neurons, float factor, uint32_t rule);

#ifdef __cplusplus
}
#endif

#endif
