#include <float.h>
#include <math.h>
#include <vdna/knn.h>

#include "vectorised.h"

/* Independent partial sums, always added up in the same order: the loops vectorise without
 * permission to reorder, and give the same bits whether they were vectorised or not. */
enum { LANES = 8, FLOAT_LANES = 16 };

/* Rows that are estimated at a time; a microcontroller's stack is small. */
enum { BLOCK = sizeof(void *) > 4 ? 32 : 8 };

/* The definition: differences, squares and sums in double. */
VDNA_VECTORISED static double distance_sq(const float *a, const float *b, size_t dim)
{
    double lane[LANES] = {0};
    size_t i = 0;
    for (; i + LANES <= dim; i += LANES)
        for (size_t l = 0; l < LANES; l++) {
            const double d = (double)a[i + l] - b[i + l];
            lane[l] += d * d;
        }

    double sum = 0;
    for (; i < dim; i++) {
        const double d = (double)a[i] - b[i];
        sum += d * d;
    }
    for (size_t l = 0; l < LANES; l++)
        sum += lane[l];
    return sum;
}

/* The same in single precision, of neighbouring rows: an estimate, from half the work. Lanes are
 * added up when all rows have theirs, which vectorises over the rows. */
VDNA_VECTORISED static void estimate_sq(const float *query, const float *map, size_t rows,
                                        size_t dim, float *out_sq)
{
    float sums[BLOCK][FLOAT_LANES];
    for (size_t row = 0; row < rows; row++, map += dim) {
        float lane[FLOAT_LANES] = {0};
        size_t i = 0;
        for (; i + FLOAT_LANES <= dim; i += FLOAT_LANES)
            for (size_t l = 0; l < FLOAT_LANES; l++) {
                const float d = query[i + l] - map[i + l];
                lane[l] += d * d;
            }
        for (size_t l = 0; l < FLOAT_LANES; l++)
            sums[row][l] = lane[l];
        for (size_t l = 0; i + l < dim; l++) {
            const float d = query[i + l] - map[i + l];
            sums[row][l] += d * d;
        }
    }
    for (size_t row = 0; row < rows; row++) {
        float sum = 0;
        for (size_t l = 0; l < FLOAT_LANES; l++)
            sum += sums[row][l];
        out_sq[row] = sum;
    }
}

/* The share of an estimate that its exact distance cannot be below. A term, none is negative, is
 * rounded by at most 2^-24 three times when it is made, and once whenever it is added: in its lane,
 * then in the sum of the lanes. */
static double sure_share(uint32_t dim)
{
    const double roundings = 3 + dim / FLOAT_LANES + 1 + FLOAT_LANES;
    return 1 - roundings / 16777216;
}

/* Is a row surely further away than `worst_sq`? Never where an estimate has left the floats, or
 * where what was lost below the smallest of them could matter. */
static int is_surely_further(float estimated_sq, double share, double worst_sq)
{
    return estimated_sq > 1e-20f && estimated_sq <= FLT_MAX && estimated_sq * share > worst_sq;
}

/* Keep `matches` sorted; a later row goes behind an earlier one of equal distance.
 * @return how many there are now, at most `capacity` */
static uint32_t insert(vdna_knn_match *matches, uint32_t count, uint32_t capacity,
                       vdna_knn_match match)
{
    if (count == capacity && match.distance_sq >= matches[count - 1].distance_sq)
        return count;
    uint32_t place = count < capacity ? count++ : count - 1;
    for (; place > 0 && match.distance_sq < matches[place - 1].distance_sq; place--)
        matches[place] = matches[place - 1];
    matches[place] = match;
    return count;
}

/* see vdna/knn.h */
vdna_status vdna_knn(const float *query, uint32_t dim, const float *map, uint32_t rows, uint32_t k,
                     vdna_knn_match *out_matches)
{
    if (!query || dim == 0 || !map || rows == 0 || k == 0 || !out_matches)
        return VDNA_ERR_ARG;
    const double share = sure_share(dim);
    float estimates[BLOCK];
    uint32_t count = 0;
    for (uint32_t row = 0; row < rows; row++, map += dim) {
        if (row % BLOCK == 0)
            estimate_sq(query, map, rows - row < BLOCK ? rows - row : BLOCK, dim, estimates);
        if (count == k &&
            is_surely_further(estimates[row % BLOCK], share, out_matches[k - 1].distance_sq))
            continue;
        const vdna_knn_match match = {distance_sq(query, map, dim), row, 0};
        if (!isfinite(match.distance_sq))
            return VDNA_ERR_NONFINITE;
        count = insert(out_matches, count, k, match);
    }
    return VDNA_OK;
}
