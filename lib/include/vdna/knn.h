/** @file vdna/knn.h
 *  @brief Nearest neighbours of an embedding among all of a map: localisation within one
 *         experience.
 *
 *  Definition: the paper localises a frame at the nearest embedding by Euclidean distance. Its
 *  square has the same order and needs no root. The squared differences are summed in single
 *  precision, that of embeddings, and always in the same order: the result has the same bits on
 *  every machine and is within (dim / 16 + 21) * 2^-24 of the exact square. The time of the sum
 *  does not depend on the data; that of inserting a row among the k nearest so far does.
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
    double distance_sq; /**< squared Euclidean distance */
    uint32_t index;     /**< row of the map */
    uint32_t reserved;  /**< 0 */
} vdna_knn_match;

/** Find the `k` map rows nearest to `query`, nearest first; equal distances by lower index.
 *  @param query        [dim], finite
 *  @param map          [rows][dim], finite; squares of differences below 1e-19 lose precision
 *  @param dim, rows, k >= 1
 *  @param out_matches  [min(k, rows)] written
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NONFINITE if a square is not finite (differences above
 *          1e19 are too large), in which case `out_matches` is unspecified */
VDNA_API vdna_status vdna_knn(const float *query, uint32_t dim, const float *map, uint32_t rows,
                              uint32_t k, vdna_knn_match *out_matches);

#ifdef __cplusplus
}
#endif

#endif
