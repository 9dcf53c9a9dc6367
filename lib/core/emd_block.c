#include <string.h>

#include <vdna/emd.h>

#include "span.h"
#include "vectorised.h"

/* Most of a distance's time goes into fetching counts from memory. Here a tile of them, some bins
 * of some neurons, of two groups of histograms is fetched once, as cumulative counts, and stays in
 * the cache while each histogram of one group meets each of the other. */
enum { GROUP = 32, TILE_NEURONS = 128, TILE_BINS = 8, WORTH_IT = 4 };

typedef struct tile_side {
    uint32_t cumulative[TILE_NEURONS]; /* up to the newest bin */
    uint32_t row[TILE_BINS][TILE_NEURONS];
} tile_side;

/* Two groups of histograms, and working memory. */
typedef struct encounter {
    const vdna_hist_view *p, *q;
    size_t count_p, count_q;
    vdna_span pair[GROUP][GROUP];
    tile_side side_p[GROUP], side_q[GROUP];
    uint32_t sum[GROUP][GROUP][TILE_NEURONS];
} encounter;

/* see vdna/emd.h */
size_t vdna_emd_block_scratch_size(uint32_t neurons)
{
    const size_t size = vdna_emd_scratch_size(neurons);
    return size > 0 && size < sizeof(encounter) ? sizeof(encounter) : size;
}

VDNA_VECTORISED static void cumulate(const uint32_t *restrict counts, size_t neurons,
                                     uint32_t *restrict cumulative, uint32_t *restrict out_row)
{
    for (size_t n = 0; n < neurons; n++)
        out_row[n] = cumulative[n] += counts[n];
}

/* Have the processor fetch counts that are needed for the next tile, while it works on this one:
 * their addresses are in steps that it does not foresee. */
static void fetch_ahead(const vdna_hist_view *view, size_t bin, size_t first, size_t neurons)
{
    enum { LINE = 64 / sizeof(uint32_t) };
    if (bin + 1 < view->bins)
        for (size_t n = 0; n < neurons; n += LINE)
            VDNA_FETCH(view->counts + bin * view->neurons + first + n);
}

/* Cumulative counts of the bins of a tile; 0 behind the last bin but one.
 * @param first  neuron */
static void fill_side(const vdna_hist_view *view, size_t bin, size_t first, size_t neurons,
                      tile_side *side)
{
    for (size_t b = 0; b < TILE_BINS; b++) {
        fetch_ahead(view, bin + b + TILE_BINS, first, neurons);
        if (bin + b + 1 < view->bins)
            cumulate(view->counts + (bin + b) * view->neurons + first, neurons, side->cumulative,
                     side->row[b]);
        else
            memset(side->row[b], 0, neurons * sizeof side->row[b][0]);
    }
}

/* Add |P - Q| over the bins of a tile; the factors make both of one mass. */
VDNA_VECTORISED static void add_tile(const tile_side *restrict p, const tile_side *restrict q,
                                     uint32_t scale_p, uint32_t scale_q, size_t neurons,
                                     uint32_t *restrict sum)
{
    for (size_t n = 0; n < neurons; n++) {
        uint32_t s = sum[n];
        for (size_t b = 0; b < TILE_BINS; b++) {
            const int32_t d = (int32_t)(p->row[b][n] * scale_p - q->row[b][n] * scale_q);
            s += (uint32_t)(d < 0 ? -d : d);
        }
        sum[n] = s;
    }
}

/* Whether the pairs can be summed tile by tile: enough of them, each histogram with one mass, and
 * sums that fit 32 bits. Finds how they are scaled. */
static int prepare(encounter *e)
{
    if (e->count_p < WORTH_IT || e->count_q < WORTH_IT)
        return 0;
    for (size_t i = 0; i < e->count_p; i++)
        for (size_t j = 0; j < e->count_q; j++) {
            const vdna_span s = vdna_span_from(e->p[i].mass, e->q[j].mass, e->p->neurons, 0);
            if (s.count < e->p->neurons || s.mass > INT32_MAX / (e->p->bins - 1))
                return 0;
            e->pair[i][j] = s;
        }
    return 1;
}

static void sum_bins(encounter *e, size_t bin, size_t first, size_t neurons)
{
    for (size_t i = 0; i < e->count_p; i++)
        fill_side(&e->p[i], bin, first, neurons, &e->side_p[i]);
    for (size_t j = 0; j < e->count_q; j++)
        fill_side(&e->q[j], bin, first, neurons, &e->side_q[j]);
    for (size_t i = 0; i < e->count_p; i++)
        for (size_t j = 0; j < e->count_q; j++)
            add_tile(&e->side_p[i], &e->side_q[j], e->pair[i][j].scale_p, e->pair[i][j].scale_q,
                     neurons, e->sum[i][j]);
}

/* Add the distances of neurons to those of all pairs, in the order of the neurons, as
 * vdna_emd_mean() does. */
static void add_distances(const encounter *e, size_t neurons, size_t stride, double *out_bins)
{
    for (size_t i = 0; i < e->count_p; i++)
        for (size_t j = 0; j < e->count_q; j++)
            for (size_t n = 0; n < neurons; n++)
                out_bins[i * stride + j] += vdna_quotient(e->sum[i][j][n], e->pair[i][j].mass);
}

/* @param stride  of the rows of out_bins */
static void meet_in_tiles(encounter *e, size_t stride, double *out_bins)
{
    const size_t neurons = e->p->neurons;
    for (size_t i = 0; i < e->count_p; i++)
        memset(out_bins + i * stride, 0, e->count_q * sizeof *out_bins);
    for (size_t first = 0; first < neurons; first += TILE_NEURONS) {
        const size_t count = neurons - first < TILE_NEURONS ? neurons - first : TILE_NEURONS;
        memset(e->side_p, 0, sizeof e->side_p);
        memset(e->side_q, 0, sizeof e->side_q);
        memset(e->sum, 0, sizeof e->sum);
        for (size_t bin = 0; bin + 1 < e->p->bins; bin += TILE_BINS)
            sum_bins(e, bin, first, count);
        add_distances(e, count, stride, out_bins);
    }
    for (size_t i = 0; i < e->count_p; i++)
        for (size_t j = 0; j < e->count_q; j++)
            out_bins[i * stride + j] /= (double)neurons;
}

static vdna_status meet_one_by_one(const vdna_hist_view *p, size_t count_p, const vdna_hist_view *q,
                                   size_t count_q, size_t stride, void *scratch,
                                   size_t scratch_size, double *out_bins)
{
    for (size_t i = 0; i < count_p; i++)
        for (size_t j = 0; j < count_q; j++) {
            const vdna_status status =
                vdna_emd_mean(&p[i], &q[j], scratch, scratch_size, &out_bins[i * stride + j]);
            if (status != VDNA_OK)
                return status;
        }
    return VDNA_OK;
}

/* All compare if each compares with the first of the other side. */
static vdna_status check_block(const vdna_hist_view *p, size_t count_p, const vdna_hist_view *q,
                               size_t count_q)
{
    vdna_status status = VDNA_OK;
    for (size_t i = 0; status == VDNA_OK && i < count_p; i++)
        status = vdna_hist_view_check_pair(&p[i], &q[0]);
    for (size_t j = 1; status == VDNA_OK && j < count_q; j++)
        status = vdna_hist_view_check_pair(&p[0], &q[j]);
    return status;
}

/* see vdna/emd.h */
vdna_status vdna_emd_block(const vdna_hist_view *p, uint32_t count_p, const vdna_hist_view *q,
                           uint32_t count_q, void *scratch, size_t scratch_size,
                           double *out_distance_bins)
{
    if (!p || count_p == 0 || !q || count_q == 0 || !scratch ||
        (uintptr_t)scratch % sizeof(int64_t) != 0 || !out_distance_bins)
        return VDNA_ERR_ARG;
    vdna_status status = check_block(p, count_p, q, count_q);
    if (status != VDNA_OK)
        return status;
    if (scratch_size < vdna_emd_block_scratch_size(p->neurons))
        return VDNA_ERR_NOMEM;

    encounter *const e = scratch;
    for (size_t i = 0; i < count_p; i += GROUP)
        for (size_t j = 0; j < count_q; j += GROUP) {
            double *const out_bins = out_distance_bins + i * count_q + j;
            e->p = p + i;
            e->q = q + j;
            e->count_p = count_p - i < GROUP ? count_p - i : GROUP;
            e->count_q = count_q - j < GROUP ? count_q - j : GROUP;
            if (prepare(e))
                meet_in_tiles(e, count_q, out_bins);
            else {
                const size_t a = e->count_p, b = e->count_q; /* the scratch is overwritten */
                status =
                    meet_one_by_one(p + i, a, q + j, b, count_q, scratch, scratch_size, out_bins);
                if (status != VDNA_OK)
                    return status;
            }
        }
    return VDNA_OK;
}
