#include <math.h>

#include <vdna/knn.h>

#include "vectorised.h"

/* Rows whose distances are summed together; a microcontroller's stack is small. */
enum { BLOCK = sizeof(void *) > 4 ? 32 : 8 };

/* Independent partial sums, always added up in the same order: the loops vectorise without
 * permission to reorder, and give the same bits, vectorised or not. */
enum { LANES = 16 };

/* Squared distances of neighbouring rows. Lanes are added up after all rows have theirs, so that
 * this step vectorises over the rows. */
VDNA_VECTORISED static void distances_sq(const float *query, const float *map, size_t rows,
                                         size_t dim, float *out_sq)
{
    float sums[BLOCK][LANES];
    for (size_t row = 0; row < rows; row++, map += dim) {
        float lane[LANES] = {0};
        size_t i = 0;
        for (; i + LANES <= dim; i += LANES)
            for (size_t l = 0; l < LANES; l++) {
                const float d = query[i + l] - map[i + l];
                lane[l] += d * d;
            }
        for (size_t l = 0; l < LANES; l++)
            sums[row][l] = lane[l];
        for (size_t l = 0; i + l < dim; l++) {
            const float d = query[i + l] - map[i + l];
            sums[row][l] += d * d;
        }
    }
    for (size_t row = 0; row < rows; row++) {
        float sum = 0;
        for (size_t l = 0; l < LANES; l++)
            sum += sums[row][l];
        out_sq[row] = sum;
    }
}

/* Keep `matches` sorted; at equal distance, earlier rows come first.
 * @return matches now, at most `capacity` */
static uint32_t insert(vdna_knn_match *matches, uint32_t count, uint32_t capacity,
                       double distance_sq, uint32_t row)
{
    if (count == capacity && distance_sq >= matches[count - 1].distance_sq)
        return count;
    if (count < capacity)
        matches[count++].reserved = 0;
    uint32_t place = count - 1;
    for (; place > 0 && distance_sq < matches[place - 1].distance_sq; place--)
        matches[place] = matches[place - 1];
    matches[place].distance_sq = distance_sq;
    matches[place].index = row;
    return count;
}

/* see vdna/knn.h */
vdna_status vdna_knn(const float *query, uint32_t dim, const float *map, uint32_t rows, uint32_t k,
                     vdna_knn_match *out_matches)
{
    if (!query || dim == 0 || !map || rows == 0 || k == 0 || !out_matches)
        return VDNA_ERR_ARG;
    float sq[BLOCK] = {0};
    uint32_t count = 0;
    for (uint32_t row = 0; row < rows; row++, map += dim) {
        if (row % BLOCK == 0)
            distances_sq(query, map, rows - row < BLOCK ? rows - row : BLOCK, dim, sq);
        if (!isfinite(sq[row % BLOCK]))
            return VDNA_ERR_NONFINITE;
        count = insert(out_matches, count, k, sq[row % BLOCK], row);
    }
    return VDNA_OK;
}
