/** @file vdna/rank.h
 *  @brief Ranking of candidate experiences: nearest first, ties in the order of the map.
 *
 *  Definition: the paper ranks by ascending mean distance; it does not mention ties.
 */
#ifndef VDNA_RANK_H
#define VDNA_RANK_H

#include <vdna/bounds.h>

#ifdef __cplusplus
extern "C" {
#endif

/** One place of a ranking. */
typedef struct vdna_rank_entry {
    double distance_bins; /**< D(live, candidate) */
    uint32_t candidate;   /**< index into the candidates */
    uint32_t tied;        /**< 1 if a neighbour in the ranking has the very same distance */
} vdna_rank_entry;

/** Sort distances, ascending; equal ones keep their order and are marked as tied.
 *  @param distance_bins  [count], finite
 *  @param count          >= 1
 *  @param out_ranking    [count]
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NONFINITE */
VDNA_API vdna_status vdna_rank_sort(const double *distance_bins, uint32_t count,
                                    vdna_rank_entry *out_ranking);

/** Rank candidates by their distance to a live Visual DNA.
 *  @param live         compares with each candidate, as for vdna_emd()
 *  @param candidates   [count]
 *  @param count        >= 1
 *  @param scratch, scratch_size  as for vdna_emd()
 *  @param out_ranking  [count]; unspecified after an error
 *  @return VDNA_OK; what vdna_emd() returns */
VDNA_API vdna_status vdna_rank(const vdna_hist_view *live, const vdna_hist_view *candidates,
                               uint32_t count, void *scratch, size_t scratch_size,
                               vdna_rank_entry *out_ranking);

/** Bytes of working memory of vdna_rank_top().
 *  @param neurons, bins  of the histograms
 *  @return bytes; 0 if `neurons` or `bins` are out of range or too many to address */
VDNA_API size_t vdna_rank_top_scratch_size(uint32_t neurons, uint32_t bins);

/** Rank candidates, the nearest of them by their distance and the rest by a lower bound of it.
 *  The first `exact` places are those of vdna_rank(), with distances and ties. The others follow by
 *  what is known of each, the bound or, if it was needed, the distance. No candidate whose bound is
 *  above the distance of place `exact` has its counts read.
 *  @param live         as for vdna_rank()
 *  @param candidates   [count]
 *  @param sums         [count], of each candidate, by vdna_bounds_sum(), one after the other
 *  @param count        >= 1
 *  @param exact        places to have exactly, >= 1; count or more = all
 *  @param scratch      aligned for int64_t, overwritten
 *  @param scratch_size at least vdna_rank_top_scratch_size()
 *  @param out_ranking  [count], never tied with a bound; unspecified after an error
 *  @param out_is_bound [count], by candidate: 1 = `distance_bins` is a lower bound; as many as are
 *                      0, so many distances were computed; unspecified after an error
 *  @return VDNA_OK; what vdna_emd() and, of `live`, vdna_bounds_sum() return */
VDNA_API vdna_status vdna_rank_top(const vdna_hist_view *live, const vdna_hist_view *candidates,
                                   const uint32_t *sums, uint32_t count, uint32_t exact,
                                   void *scratch, size_t scratch_size, vdna_rank_entry *out_ranking,
                                   uint8_t *out_is_bound);

#ifdef __cplusplus
}
#endif

#endif
