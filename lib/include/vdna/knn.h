/** @file vdna/knn.h
 *  @brief Exact nearest neighbours of an embedding: localisation within one experience.
 *
 *  Definition: the paper localises a frame at the nearest embedding by Euclidean distance. Its
 *  square has the same order and needs no root.
 */
#ifndef VDNA_KNN_H
#define VDNA_KNN_H

#include <stddef.h>
#include <vdna/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/** One neighbour. */
typedef struct vdna_knn_match {
    double distance_sq; /**< squared Euclidean distance, summed in double precision */
    uint32_t index;     /**< row of the map */
    uint32_t reserved;  /**< 0 */
} vdna_knn_match;

/** Find the `k` map rows nearest to `query`, nearest first; equal distances by lower index.
 *  @param query        [dim], finite
 *  @param map          [rows][dim], finite
 *  @param dim, rows, k >= 1
 *  @param out_matches  [min(k, rows)] written
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NONFINITE if a distance is not finite, in which case
 *          `out_matches` is unspecified */
VDNA_API vdna_status vdna_knn(const float *query, uint32_t dim, const float *map, uint32_t rows,
                              uint32_t k, vdna_knn_match *out_matches);

#ifdef __cplusplus
}
#endif

#endif
