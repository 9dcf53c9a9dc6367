#include <math.h>
#include <vdna/knn.h>

/* Independent partial sums, always added up in the same order: the loop vectorises without
 * permission to reorder, and gives the same bits whether it was vectorised or not. */
#define LANES 8

static double distance_sq(const float *a, const float *b, size_t dim)
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
    uint32_t count = 0;
    for (uint32_t row = 0; row < rows; row++) {
        const vdna_knn_match match = {distance_sq(query, map + (size_t)row * dim, dim), row, 0};
        if (!isfinite(match.distance_sq))
            return VDNA_ERR_NONFINITE;
        count = insert(out_matches, count, k, match);
    }
    return VDNA_OK;
}
