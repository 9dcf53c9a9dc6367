/** @file vdna/rank.h
 *  @brief Ranking of candidate experiences: nearest first, ties in the order of the map.
 *
 *  Definition: the paper ranks by ascending mean distance; it does not mention ties.
 */
#ifndef VDNA_RANK_H
#define VDNA_RANK_H

#include <vdna/emd.h>

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

#ifdef __cplusplus
}
#endif

#endif
