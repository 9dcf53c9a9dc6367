/** @file vdna/baseline.h
 *  @brief Baselines for Visual DNA, and metrics of rankings.
 *
 *  Baselines: Frechet distance of embeddings, pixel intensity, chance. Metrics: how much recall a
 *  predicted ranking loses against the true one. Definitions: docs/internals/DESIGN.md, Metrics.
 */
#ifndef VDNA_BASELINE_H
#define VDNA_BASELINE_H

#include <vdna/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Frechet distance |m1 - m2|^2 + tr(S1 + S2 - 2 (S1 S2)^(1/2)) of two sets of embeddings, with
 *  unbiased covariances. Sound when there are fewer frames than dimensions: the trace of the root
 *  is the sum of the singular values of X1 X2^T, and no covariance is formed.
 *  @param a, b          [frames][dim], finite
 *  @param frames_a, frames_b  >= 2
 *  @param dim           numbers in an embedding, >= 1
 *  @param out_distance  in squared embedding units, >= 0
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NONFINITE; VDNA_ERR_NOMEM */
VDNA_API vdna_status vdna_frechet(const float *a, uint32_t frames_a, const float *b,
                                  uint32_t frames_b, uint32_t dim, double *out_distance);

/** Pixel intensity: the difference of the mean grey levels of two sets of frames.
 *  @param a, b          [frames], mean grey level of each frame, 0..255
 *  @param frames_a, frames_b  >= 1
 *  @param out_distance  0..255
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NONFINITE */
VDNA_API vdna_status vdna_intensity(const float *a, uint32_t frames_a, const float *b,
                                    uint32_t frames_b, double *out_distance);

/** Recalls, and the distances that should predict them, of every query against every reference.
 *  A NaN recall marks a query that was not localised against this reference, usually because it is
 *  the query itself; such pairs are left out. */
typedef struct vdna_ranking_table {
    const double *recall;   /**< [queries][references], percent, higher is better */
    const double *distance; /**< [queries][references], lower is nearer; NULL = random ranking: each
                                 metric is its exact expectation over all permutations */
    uint32_t queries;       /**< >= 1 */
    uint32_t references;    /**< >= 1 */
} vdna_ranking_table;

/** How well distances rank recalls. Percentages are in the unit of the recalls. A query whose recalls
 *  are all equal, to 1e-9, ranks nothing: every order is the true one. It is left out of every
 *  metric; if no query is left, all of them are NaN, those of a random ranking included. So is a
 *  coefficient whose distances are all equal. */
typedef struct vdna_ranking_metrics {
    double ranking_error_swap_once; /**< each unordered pair {a, b} for which, at some rank, the
                                       truth has one and the prediction the other counts once with
                                         |R_a - R_b|; summed, divided by the number of pairs (query,
                                         reference) */
    double ranking_error_half_l1;   /**< |R_predicted - R_true| / 2 at each rank, summed and divided
                                         as above */
    double regret;          /**< best recall less that of the first choice, mean over queries */
    double kendall_tau;     /**< tau-b of predicted and true order, mean over queries, -1..1 */
    double pearson_within;  /**< correlation of distance and recall, mean over queries, -1..1 */
    double spearman_within; /**< as pearson_within, of ranks */
    double pearson_pooled;  /**< correlation over all pairs of all queries, -1..1 */
    double spearman_pooled; /**< as pearson_pooled, of ranks */
    uint32_t queries;       /**< judged */
    uint32_t left_out;      /**< queries that rank nothing */
} vdna_ranking_metrics;

/** Judge a table of distances against a table of recalls. Ties in either order are broken by the
 *  order of the references, as vdna_rank_sort() does.
 *  @param table        finite distances wherever there is a recall
 *  @param out_metrics  each in its own unit
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NONFINITE if a pair with a recall has no finite
 * distance; VDNA_ERR_EMPTY if there is no pair at all; VDNA_ERR_NOMEM */
VDNA_API vdna_status vdna_judge_ranking(const vdna_ranking_table *table,
                                        vdna_ranking_metrics *out_metrics);

#ifdef __cplusplus
}
#endif

#endif
