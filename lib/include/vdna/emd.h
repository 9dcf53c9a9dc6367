/** @file vdna/emd.h
 *  @brief Earth Mover's Distance between histograms, exact.
 *
 *  Definition: the distance of the reference package of Visual DNA, in the unit of the paper's
 *  tables; docs/internals/DESIGN.md says why it is summed in integers.
 *
 *  Per neuron: the sum over the bins of |P[b] - Q[b]|, P and Q being the cumulative counts divided
 *  by their mass. Its unit is bins: moving every sample by k bins gives k. It is summed in
 *  integers, divided and rounded once, so it is the double nearest to the true distance, and the
 *  same counts give the same bits on every machine.
 */
#ifndef VDNA_EMD_H
#define VDNA_EMD_H

#include <vdna/hist.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Bytes of working memory. The block may be reused for any call.
 *  @param neurons  of the histograms to compare
 *  @return bytes; 0 if `neurons` is 0 or too many to address */
VDNA_API size_t vdna_emd_scratch_size(uint32_t neurons);

/** Distance of each neuron.
 *  @param p, q     compare, as vdna_hist_view_check_pair() says
 *  @param scratch  aligned for int64_t, vdna_emd_scratch_size() bytes, overwritten
 *  @param scratch_size  bytes of scratch
 *  @param out_emd_bins  [neurons], 0..bins-1; unspecified after an error
 *  @return VDNA_OK; VDNA_ERR_ARG, VDNA_ERR_MISMATCH or VDNA_ERR_EMPTY if they do not compare;
 *          VDNA_ERR_NOMEM if the scratch is too small; VDNA_ERR_OVERFLOW if
 *          (bins - 1) times the least common multiple of both masses passes INT64_MAX for a neuron
 */
VDNA_API vdna_status vdna_emd(const vdna_hist_view *p, const vdna_hist_view *q, void *scratch,
                              size_t scratch_size, double *out_emd_bins);

/** Distance D(p, q) of two Visual DNAs: the mean over their neurons, in bins.
 *  @param p, q, scratch, scratch_size  as for vdna_emd()
 *  @param out_distance_bins  one number, 0..bins-1
 *  @return as vdna_emd() */
VDNA_API vdna_status vdna_emd_mean(const vdna_hist_view *p, const vdna_hist_view *q, void *scratch,
                                   size_t scratch_size, double *out_distance_bins);

/** Bytes of working memory of vdna_emd_block().
 *  @param neurons  of the histograms to compare
 *  @return bytes; 0 if `neurons` is 0 or too many to address */
VDNA_API size_t vdna_emd_block_scratch_size(uint32_t neurons);

/** Distances of many pairs: of each Visual DNA of one side to each of the other, with the bits of
 *  vdna_emd_mean(). It is faster where either side has four or more, since counts are fetched once
 *  for many pairs, as long as each Visual DNA has one mass, as those of a network with one tap do.
 *  @param p, q     [count_p] and [count_q]; all compare
 *  @param count_p, count_q  >= 1
 *  @param scratch  aligned for int64_t, vdna_emd_block_scratch_size() bytes, overwritten
 *  @param scratch_size  bytes of scratch
 *  @param out_distance_bins  [count_p][count_q], 0..bins-1; unspecified after an error
 *  @return as vdna_emd() */
VDNA_API vdna_status vdna_emd_block(const vdna_hist_view *p, uint32_t count_p,
                                    const vdna_hist_view *q, uint32_t count_q, void *scratch,
                                    size_t scratch_size, double *out_distance_bins);

#ifdef __cplusplus
}
#endif

#endif
