#include <string.h>

#include <vdna/bounds.h>

#include "span.h"
#include "vectorised.h"

/* Blocks of bins; the last bin is in none. */
static size_t blocks_of(uint32_t bins)
{
    return (bins - 2) / VDNA_BOUNDS_BINS + 1;
}

/* see vdna/bounds.h */
size_t vdna_bounds_size(uint32_t neurons, uint32_t bins)
{
    if (bins < VDNA_HIST_BINS_MIN || bins > VDNA_HIST_BINS_MAX)
        return 0;
    const uint64_t size = (uint64_t)neurons * blocks_of(bins) * sizeof(uint32_t);
    return size <= SIZE_MAX / 2 ? (size_t)size : 0;
}

/* Whether no sum of a block, its bins times the mass at most, passes 32 bits. */
static int fits(const vdna_hist_view *view)
{
    const uint32_t terms = view->bins - 1;
    const uint32_t most = UINT32_MAX / (terms < VDNA_BOUNDS_BINS ? terms : VDNA_BOUNDS_BINS);
    uint32_t mass = 0;
    for (size_t n = 0; n < view->neurons; n++)
        mass = view->mass[n] > mass ? view->mass[n] : mass;
    return mass <= most;
}

VDNA_VECTORISED static void add_bin(const uint32_t *restrict row, size_t neurons,
                                    uint32_t *restrict cumulative, uint32_t *restrict sums)
{
    for (size_t n = 0; n < neurons; n++)
        sums[n] += cumulative[n] += row[n];
}

/* see vdna/bounds.h */
vdna_status vdna_bounds_sum(const vdna_hist_view *view, void *scratch, size_t scratch_size,
                            uint32_t *out_sums)
{
    if (!out_sums)
        return VDNA_ERR_ARG;
    const vdna_status status = vdna_check_pair(view, view, scratch, scratch_size);
    if (status != VDNA_OK)
        return status;
    if (!fits(view))
        return VDNA_ERR_OVERFLOW;
    uint32_t *const cumulative = scratch;
    memset(cumulative, 0, view->neurons * sizeof *cumulative);
    memset(out_sums, 0, vdna_bounds_size(view->neurons, view->bins));
    for (size_t b = 0; b + 1 < view->bins; b++)
        add_bin(view->counts + b * view->neurons, view->neurons, cumulative,
                out_sums + b / VDNA_BOUNDS_BINS * view->neurons);
    return VDNA_OK;
}

VDNA_VECTORISED static void add_block(const uint32_t *restrict row_p,
                                      const uint32_t *restrict row_q, uint32_t scale_p,
                                      uint32_t scale_q, size_t neurons, uint64_t *restrict sum)
{
    for (size_t n = 0; n < neurons; n++) {
        const int64_t d = (int64_t)((uint64_t)row_p[n] * scale_p - (uint64_t)row_q[n] * scale_q);
        sum[n] += (uint64_t)(d < 0 ? -d : d);
    }
}

/* see vdna/bounds.h; a block sum is at most its bins times the common mass, and all of them
 * together are at most what vdna_emd() sums up. */
vdna_status vdna_bounds_from_sums(const uint32_t *sums_p, const uint32_t *mass_p,
                                  const uint32_t *sums_q, const uint32_t *mass_q, uint32_t neurons,
                                  uint32_t bins, void *scratch, size_t scratch_size,
                                  double *out_bound_bins)
{
    if (!sums_p || !mass_p || !sums_q || !mass_q || vdna_bounds_size(neurons, bins) == 0 ||
        !out_bound_bins)
        return VDNA_ERR_ARG;
    const vdna_status status = vdna_check_scratch(neurons, scratch, scratch_size);
    if (status != VDNA_OK)
        return status;
    uint64_t *const sum = scratch;
    const uint64_t terms = bins - 1;
    memset(sum, 0, neurons * sizeof *sum);
    double total = 0;
    for (size_t first = 0; first < neurons;) {
        if (mass_p[first] == 0 || mass_q[first] == 0)
            return VDNA_ERR_EMPTY;
        const vdna_span s = vdna_span_from(mass_p, mass_q, neurons, first);
        if (s.mass > INT64_MAX / terms)
            return VDNA_ERR_OVERFLOW;
        for (size_t block = 0, at = first; block < blocks_of(bins); block++, at += neurons)
            add_block(sums_p + at, sums_q + at, s.scale_p, s.scale_q, s.count, sum + first);
        first += s.count;
        for (size_t n = s.first; n < first; n++)
            total += vdna_quotient(sum[n], s.mass);
    }
    *out_bound_bins = total / neurons;
    return VDNA_OK;
}

/* see vdna/bounds.h */
vdna_status vdna_bounds_mean(const vdna_hist_view *p, const uint32_t *sums_p,
                             const vdna_hist_view *q, const uint32_t *sums_q, void *scratch,
                             size_t scratch_size, double *out_bound_bins)
{
    const vdna_status status = vdna_hist_view_check_pair(p, q);
    if (status != VDNA_OK)
        return status;
    return vdna_bounds_from_sums(sums_p, p->mass, sums_q, q->mass, p->neurons, p->bins, scratch,
                                 scratch_size, out_bound_bins);
}
