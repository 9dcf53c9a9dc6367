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

/* ---- The nearest alone, faster ----
 *
 * Most time of a search goes into fetching the map from memory. Codes of 8 bits are a quarter of
 * it, and the triangle inequality shows for most rows that they cannot be the nearest; only the
 * others are fetched. The answer has the bits of vdna_knn(). How many rows are fetched, so the
 * time, depends on the data: with rows that are all about as far away, it is longer than that of
 * vdna_knn() by a quarter. */

/** Bytes that vdna_knn_encode() needs.
 *  @param dim   of each row
 *  @param rows  of the map
 *  @return bytes; 0 if there are no codes: `dim` or `rows` is 0, `dim` above 4096, or pointers have
 *          32 bits */
VDNA_API size_t vdna_knn_codes_size(uint32_t dim, uint32_t rows);

/** Make the codes of a map.
 *  @param map  [rows][dim], within -1e15..1e15
 *  @param dim, rows  for which there are codes
 *  @param mem  aligned for double; holds the codes
 *  @param mem_size  bytes of mem, vdna_knn_codes_size() or more
 *  @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NOMEM if too small; VDNA_ERR_NONFINITE for a number that
 *          is not finite, or beyond that. After an error `mem` is unchanged. */
VDNA_API vdna_status vdna_knn_encode(const float *map, uint32_t dim, uint32_t rows, void *mem,
                                     size_t mem_size);

/** Find the map row nearest to `query`, to the bit as vdna_knn() does with k = 1.
 *  @param query, dim, map, rows  as of vdna_knn()
 *  @param codes      of this map, by vdna_knn_encode(); NULL = none
 *  @param out_match  the nearest row
 *  @return as vdna_knn() */
VDNA_API vdna_status vdna_knn_nearest(const float *query, uint32_t dim, const float *map,
                                      uint32_t rows, const void *codes, vdna_knn_match *out_match);

#ifdef __cplusplus
}
#endif

#endif
