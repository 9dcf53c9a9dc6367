#include <math.h>
#include <string.h>

#include <vdna/knn.h>

#include "elementary.h"
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

/* ---- With codes ---- */

/* Larger numbers are searched without codes: no square may overflow. */
static const float number_max = 1e15f;

/* Every how many rows one is tried for a first guess: neighbouring frames are alike. */
enum { GUESS_STEP = 16 };

/* The codes of a query lie on the stack. Sums of their products with a row's fit 32 bits. No codes
 * on a microcontroller: it has its map at hand, and a small stack. */
enum { DIM_MAX = sizeof(void *) > 4 ? 4096 : 0, ROW_CODE_MAX = 127, QUERY_CODE_MAX = 4095 };
enum { CODES = DIM_MAX + 1 }; /* of a query; 0 would be no size */

/* What is known of a row beside its codes. */
typedef struct coded_row {
    double square; /* squared length of what the codes stand for */
    double error;  /* at least the distance from that to the row */
    float scale;   /* what a code counts */
    uint32_t reserved;
} coded_row;

/* The largest magnitude; not finite if a value is not. Magnitudes are in the order of their bits,
 * and the largest of integers vectorises. */
VDNA_VECTORISED_FROM_V2 static float largest_of(const float *values, size_t dim)
{
    uint32_t largest = 0;
    for (size_t i = 0; i < dim; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        bits &= 0x7fffffff;
        largest = bits > largest ? bits : largest;
    }
    float magnitude;
    memcpy(&magnitude, &largest, sizeof magnitude);
    return magnitude;
}

static inline int16_t rounded_code(float value, float per_unit)
{
    const float steps = value * per_unit;
    return (int16_t)(steps < 0 ? steps - 0.5f : steps + 0.5f);
}

static inline double error_sq_of(float value, float scale, int16_t code)
{
    const double error = value - (double)scale * code;
    return error * error;
}

/* Encode a row or a query. Any codes do, because their error is measured: all are 0 if the numbers
 * are very small.
 * @param largest  of largest_of()
 * @param most     code of the largest */
VDNA_VECTORISED static void encode(const float *values, size_t dim, float largest, int16_t most,
                                   int16_t *codes, coded_row *out)
{
    const float scale = largest / most, per_unit = scale > 1e-30f ? 1 / scale : 0;
    int64_t square = 0;
    for (size_t i = 0; i < dim; i++)
        codes[i] = rounded_code(values[i], per_unit);
    for (size_t i = 0; i < dim; i++) {
        const int32_t code = codes[i];
        const int32_t code_sq = code * code;
        square += code_sq;
    }

    double lane[LANES] = {0}, error_sq = 0;
    size_t i = 0;
    for (; i + LANES <= dim; i += LANES)
        for (size_t l = 0; l < LANES; l++)
            lane[l] += error_sq_of(values[i + l], scale, codes[i + l]);
    for (; i < dim; i++)
        error_sq += error_sq_of(values[i], scale, codes[i]);
    for (size_t l = 0; l < LANES; l++)
        error_sq += lane[l];

    out->square = (double)scale * scale * (double)square;
    out->error = vdna_sqrt(error_sq) * (1 + 1e-9);
    out->scale = scale;
    out->reserved = 0;
}

static void encode_row(const float *row, size_t dim, int8_t *codes, coded_row *out)
{
    int16_t wide[CODES] = {0};
    encode(row, dim, largest_of(row, dim), ROW_CODE_MAX, wide, out);
    for (size_t i = 0; i < dim; i++)
        codes[i] = (int8_t)wide[i];
}

/* see vdna/knn.h */
size_t vdna_knn_codes_size(uint32_t dim, uint32_t rows)
{
    if (dim == 0 || dim > DIM_MAX || rows == 0)
        return 0;
    const uint64_t size = rows * (sizeof(coded_row) + (uint64_t)dim);
    return size <= SIZE_MAX / 2 ? (size_t)size : 0;
}

/* see vdna/knn.h */
vdna_status vdna_knn_encode(const float *map, uint32_t dim, uint32_t rows, void *mem,
                            size_t mem_size)
{
    const size_t needed = vdna_knn_codes_size(dim, rows);
    if (!map || !mem || needed == 0 || (uintptr_t)mem % sizeof(double) != 0)
        return VDNA_ERR_ARG;
    if (mem_size < needed)
        return VDNA_ERR_NOMEM;
    for (size_t row = 0; row < rows; row++)
        if (!(largest_of(map + row * dim, dim) <= number_max))
            return VDNA_ERR_NONFINITE;

    coded_row *const coded = mem;
    int8_t *const codes = (int8_t *)(coded + rows);
    for (size_t row = 0; row < rows; row++)
        encode_row(map + row * dim, dim, codes + row * dim, &coded[row]);
    return VDNA_OK;
}

/* Products of a query's codes with those of rows that are `stride` apart. Sums of integers do not
 * depend on their order: they vectorise. */
VDNA_VECTORISED static void products(const int16_t *query, const int8_t *codes, size_t rows,
                                     size_t stride, size_t dim, int32_t *out)
{
    for (size_t row = 0; row < rows; row++, codes += stride) {
        int32_t product = 0;
        for (size_t i = 0; i < dim; i++)
            product += (int32_t)query[i] * codes[i];
        out[row] = product;
    }
}

/* A search for the nearest row. */
typedef struct search {
    const float *query, *map;
    const coded_row *coded;
    const int8_t *codes;
    size_t dim;
    uint32_t rows;
    coded_row coded_query;
    double radius; /* a nearer row is within it */
    vdna_knn_match nearest;
    int16_t query_codes[CODES];
} search;

/* Products of the query with `count` rows from `row` on, each `step` after the one before. */
static void multiply(const search *s, size_t row, size_t step, size_t count, int32_t *out)
{
    products(s->query_codes, s->codes + row * s->dim, count, step * s->dim, s->dim, out);
}

/* Squared distance of what the codes of query and row stand for. */
static double coded_distance_sq(const search *s, uint32_t row, int32_t product)
{
    const coded_row *const q = &s->coded_query, *const r = &s->coded[row];
    return q->square + r->square - 2.0 * q->scale * r->scale * product;
}

/* Whether a row may be the nearest. By the triangle inequality, query and row are no nearer than
 * what their codes stand for less the errors of these; the tiny share is what rounding may add. */
static int may_be_nearest(const search *s, uint32_t row, int32_t product)
{
    const coded_row *const q = &s->coded_query, *const r = &s->coded[row];
    const double reach = s->radius + q->error + r->error;
    return coded_distance_sq(s, row, product) - 1e-12 * (q->square + r->square) <= reach * reach;
}

/* Compare a row with the nearest so far as vdna_knn() does. */
static void try_row(search *s, uint32_t row)
{
    float sq = 0;
    distances_sq(s->query, s->map + row * s->dim, 1, s->dim, &sq);
    if (sq > s->nearest.distance_sq || (sq == s->nearest.distance_sq && row > s->nearest.index))
        return;
    s->nearest.distance_sq = sq;
    s->nearest.index = row;
    /* By twice the error that vdna/knn.h promises: of any row beyond it, the rounded square is
     * greater. The last term is for squares of differences that lose precision. */
    s->radius = vdna_sqrt(sq * (1 + ((double)s->dim / 16 + 21) * 0x1p-23) + 1e-30);
}

/* The nearest of some rows by their codes. */
static uint32_t guess(const search *s)
{
    int32_t product[BLOCK] = {0};
    uint32_t best = 0;
    double least = INFINITY;
    for (uint32_t row = 0; row < s->rows;) {
        const uint32_t left = (s->rows - row - 1) / GUESS_STEP + 1;
        const uint32_t count = left < BLOCK ? left : BLOCK;
        multiply(s, row, GUESS_STEP, count, product);
        for (uint32_t i = 0; i < count; i++, row += GUESS_STEP) {
            const double distance_sq = coded_distance_sq(s, row, product[i]);
            best = distance_sq < least ? row : best;
            least = distance_sq < least ? distance_sq : least;
        }
    }
    return best;
}

static void try_all_rows(search *s)
{
    int32_t product[BLOCK] = {0};
    for (uint32_t row = 0; row < s->rows; row += BLOCK) {
        const uint32_t count = s->rows - row < BLOCK ? s->rows - row : BLOCK;
        multiply(s, row, 1, count, product);
        for (uint32_t i = 0; i < count; i++)
            if (may_be_nearest(s, row + i, product[i]))
                try_row(s, row + i);
    }
}

/* see vdna/knn.h */
vdna_status vdna_knn_nearest(const float *query, uint32_t dim, const float *map, uint32_t rows,
                             const void *codes, vdna_knn_match *out_match)
{
    if (!codes || !query || !map || !out_match || vdna_knn_codes_size(dim, rows) == 0)
        return vdna_knn(query, dim, map, rows, 1, out_match);
    const float largest = largest_of(query, dim);
    if (!(largest <= number_max))
        return vdna_knn(query, dim, map, rows, 1, out_match);

    const coded_row *const coded = codes;
    search s = {.query = query,
                .map = map,
                .coded = coded,
                .codes = (const int8_t *)(coded + rows),
                .dim = dim,
                .rows = rows,
                .nearest = {INFINITY, 0, 0}};
    encode(query, dim, largest, QUERY_CODE_MAX, s.query_codes, &s.coded_query);
    try_row(&s, guess(&s));
    try_all_rows(&s);
    *out_match = s.nearest;
    return VDNA_OK;
}
