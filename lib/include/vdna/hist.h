/** @file vdna/hist.h
 *  @brief Fixed-bin activation histograms: the "Visual DNA" of a set of pictures.
 *
 *  A histogram counts, per neuron, how often its activation fell into each of `bins` equal bins
 *  of its range: with x = (a - mid) / half clamped to -1..1, in double precision,
 *  bin = min(bins - 1, floor((x + 1) * bins / 2)). Its size does not depend on the number of
 *  frames, and its counts do not depend on their order or on how they were batched.
 *
 *  Counts are bin-major, [bins][neurons], so that a pass over the bins runs over all neurons at
 *  once and compilers vectorise it.
 *
 *  Definition: the bins are those of torch.histc(), which the reference package of Visual DNA uses.
 */
#ifndef VDNA_HIST_H
#define VDNA_HIST_H

#include <vdna/activation.h>
#include <vdna/range.h>

#ifdef __cplusplus
extern "C" {
#endif

#define VDNA_HIST_BINS_DEFAULT 1000u /**< as in the paper and its reference package */
#define VDNA_HIST_BINS_MIN 2u        /**< fewest bins: one alone has no distance */
#define VDNA_HIST_BINS_MAX 65536u    /**< most bins */

/** Shape of a histogram. Fill with vdna_hist_config_init(), then set `neurons` and `range`. */
typedef struct vdna_hist_config {
    uint32_t struct_size; /**< bytes of this struct, set by vdna_hist_config_init() */
    uint32_t neurons;     /**< >= 1, of all taps together: 768 for Mugs ViT-B/16 */
    uint32_t bins;        /**< VDNA_HIST_BINS_MIN..VDNA_HIST_BINS_MAX */
    const float *range;   /**< [neurons][2], passes vdna_range_check(); borrowed as long as the
                               histogram is in use */
} vdna_hist_config;

/** One histogram. Defined here so that it can sit anywhere; read the fields, never write them. */
typedef struct vdna_hist {
    const float *range;  /**< [neurons][2], the caller's */
    uint32_t *counts;    /**< [bins][neurons], inside the caller's block */
    uint32_t *mass;      /**< [neurons], samples counted per neuron, inside the caller's block */
    uint32_t *saturated; /**< [neurons], samples beyond the range (they land in an edge bin) */
    uint32_t neurons;    /**< of all taps together */
    uint32_t bins;       /**< counts per neuron */
    uint32_t frames;     /**< frames added, less frames subtracted */
} vdna_hist;

/** A histogram to read, from a vdna_hist, a mapped experience file or the caller. All pointers are
 *  borrowed. */
typedef struct vdna_hist_view {
    const float *range;     /**< [neurons][2] */
    const uint32_t *counts; /**< [bins][neurons] */
    const uint32_t *mass;   /**< [neurons], the sum of each neuron's counts */
    uint32_t neurons;       /**< >= 1 */
    uint32_t bins;          /**< VDNA_HIST_BINS_MIN..VDNA_HIST_BINS_MAX */
} vdna_hist_view;

/** Write the defaults: 1000 bins; neurons = 0 and range = NULL, which the caller must set.
 *  @param config  NULL is allowed */
VDNA_API void vdna_hist_config_init(vdna_hist_config *config);

/** Bytes that vdna_hist_init() needs.
 *  @param config  its range is ignored
 *  @return bytes; 0 if neurons or bins are out of range or too many to address */
VDNA_API size_t vdna_hist_mem_size(const vdna_hist_config *config);

/** Make an empty histogram in `mem`, which must stay valid while `out_hist` is in use.
 *  @param config  needed for this call only; its range is borrowed
 *  @param mem  aligned for uint32_t, `mem_size` bytes
 *  @param mem_size  at least vdna_hist_mem_size()
 *  @param out_hist  may be moved, but not copied: its state is in the struct and the block
 *  @return VDNA_OK; VDNA_ERR_ARG for a bad config or alignment; VDNA_ERR_NOMEM if too small */
VDNA_API vdna_status vdna_hist_init(const vdna_hist_config *config, void *mem, size_t mem_size,
                                    vdna_hist *out_hist);

/** Count one frame. After an error the histogram is unchanged: a frame counts whole or not at all.
 *  @param hist  counted into
 *  @param taps  [tap_count]; their neurons, one tap after the other, are the histogram's neurons
 *  @param tap_count  >= 1
 *  @return VDNA_OK; what vdna_activations_check() returns; VDNA_ERR_FULL if a mass or the number
 *          of frames would pass UINT32_MAX */
VDNA_API vdna_status vdna_hist_add(vdna_hist *hist, const vdna_activations *taps, size_t tap_count);

/** Add all of `other`: hist(A + B) = hist(A) + hist(B), exactly. Unchanged after an error.
 *  @param hist   added to
 *  @param other  same shape and range values
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_MISMATCH if shapes or ranges differ; VDNA_ERR_FULL */
VDNA_API vdna_status vdna_hist_merge(vdna_hist *hist, const vdna_hist *other);

/** Take `other` out again, exactly. Unchanged after an error.
 *  @param hist   taken from
 *  @param other  same shape and range values
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_MISMATCH if shapes or ranges differ;
 *          VDNA_ERR_UNDERFLOW if `other` holds anything that `hist` does not */
VDNA_API vdna_status vdna_hist_subtract(vdna_hist *hist, const vdna_hist *other);

/** Forget all samples; shape and range stay.
 *  @param hist  NULL is allowed */
VDNA_API void vdna_hist_reset(vdna_hist *hist);

/** Look at a histogram; the view follows later changes.
 *  @param hist      borrowed as long as the view is in use
 *  @param out_view  untouched if an argument is NULL */
VDNA_API void vdna_hist_view_of(const vdna_hist *hist, vdna_hist_view *out_view);

/** Check that two histograms compare, so that their distance means something.
 *  @param p, q  read in full except for the counts
 *  @return VDNA_OK; VDNA_ERR_ARG if a view is not valid (a NULL, neurons or bins out of range);
 *          VDNA_ERR_MISMATCH if shapes or range values differ; VDNA_ERR_EMPTY if a neuron of
 *          either has no samples */
VDNA_API vdna_status vdna_hist_view_check_pair(const vdna_hist_view *p, const vdna_hist_view *q);

/** Find where a neuron's samples lie on average.
 *  @param view     valid, as vdna_hist_view_check_pair() says
 *  @param neuron   index
 *  @param out_bin  0..bins-1
 *  @return VDNA_OK; VDNA_ERR_ARG if there is no such neuron; VDNA_ERR_EMPTY if it has no samples */
VDNA_API vdna_status vdna_hist_view_mean(const vdna_hist_view *view, uint32_t neuron,
                                         double *out_bin);

#ifdef __cplusplus
}
#endif

#endif
