/** @file vdna/bounds.h
 *  @brief Lower bounds of the Earth Mover's Distance, from a small summary of each histogram.
 *
 *  The summary of a histogram: per neuron, the sums of its cumulative counts over blocks of
 *  VDNA_BOUNDS_BINS bins. With 1000 bins it has 1/25 of the numbers, and the bound made of two of
 *  them takes about 1/25 of the time of the distance. vdna_rank_top() needs few distances with it.
 *
 *  Why it is a bound. Per neuron the distance is the sum of |P[b] - Q[b]| over the bins, P and Q
 *  being cumulative shares. In each block |sum of (P[b] - Q[b])| <= sum of |P[b] - Q[b]|, by the
 *  triangle inequality; the left sides, of all blocks, make the bound. They are equal where the
 * sign of P[b] - Q[b] is the same in the whole block, so the bound is seldom far below. Both sides
 *  are whole numbers over the same common mass, and rounded, added and divided in the same
 *  order; rounding keeps the order of two numbers. So the bound as a double never passes the double
 *  that vdna_emd_mean() returns.
 */
#ifndef VDNA_BOUNDS_H
#define VDNA_BOUNDS_H

#include <vdna/emd.h>

#ifdef __cplusplus
extern "C" {
#endif

#define VDNA_BOUNDS_BINS 25u /**< bins in a block; the last block may have fewer */

/** Bytes of the block sums of one histogram: uint32_t [blocks][neurons], of all bins but the last,
 *  whose cumulative share is 1 in every histogram.
 *  @param neurons, bins  of the histogram
 *  @return bytes; 0 if `neurons` or `bins` are out of range or too many to address */
VDNA_API size_t vdna_bounds_size(uint32_t neurons, uint32_t bins);

/** Sum up a histogram.
 *  @param view     valid and without an empty neuron
 *  @param scratch  aligned for int64_t, vdna_emd_scratch_size() bytes, overwritten
 *  @param scratch_size  bytes of scratch
 *  @param out_sums  vdna_bounds_size() bytes; unspecified after an error
 *  @return VDNA_OK; VDNA_ERR_ARG or VDNA_ERR_EMPTY for a bad view; VDNA_ERR_NOMEM if the scratch is
 *          too small; VDNA_ERR_OVERFLOW if a mass passes UINT32_MAX / VDNA_BOUNDS_BINS, 171 million
 */
VDNA_API vdna_status vdna_bounds_sum(const vdna_hist_view *view, void *scratch, size_t scratch_size,
                                     uint32_t *out_sums);

/** Bound the distance of two Visual DNAs from below.
 *  @param p, q     compare, as vdna_hist_view_check_pair() says; their counts are not read
 *  @param sums_p, sums_q  of vdna_bounds_sum()
 *  @param scratch, scratch_size  as for vdna_emd()
 *  @param out_bound_bins  0..bins-1, at most what vdna_emd_mean() says
 *  @return as vdna_emd() */
VDNA_API vdna_status vdna_bounds_mean(const vdna_hist_view *p, const uint32_t *sums_p,
                                      const vdna_hist_view *q, const uint32_t *sums_q,
                                      void *scratch, size_t scratch_size, double *out_bound_bins);

/** Bound the distance of two Visual DNAs of which only the sums are at hand, such as the rows of an
 *  index. The same bits as vdna_bounds_mean(), which checks the histograms and calls this.
 *  @param sums_p, sums_q  of vdna_bounds_sum(), of histograms that compare
 *  @param mass_p, mass_q  [neurons], of the histograms
 *  @param neurons, bins   of each histogram
 *  @param scratch, scratch_size  as for vdna_emd()
 *  @param out_bound_bins  0..bins-1, at most what vdna_emd_mean() says of the histograms
 *  @return VDNA_OK; VDNA_ERR_ARG for a NULL, a misaligned scratch, or neurons or bins out of range;
 *          VDNA_ERR_NOMEM, VDNA_ERR_EMPTY and VDNA_ERR_OVERFLOW as vdna_emd() */
VDNA_API vdna_status vdna_bounds_from_sums(const uint32_t *sums_p, const uint32_t *mass_p,
                                           const uint32_t *sums_q, const uint32_t *mass_q,
                                           uint32_t neurons, uint32_t bins, void *scratch,
                                           size_t scratch_size, double *out_bound_bins);

#ifdef __cplusplus
}
#endif

#endif
