#include <string.h>

#include <vdna/emd.h>

#include "span.h"
#include "vectorised.h"

/* Working memory, for the neurons of a span. */
typedef struct work {
    int64_t *difference; /* [neurons], cumulative P * scale_p - cumulative Q * scale_q so far */
    int64_t *sum;        /* [neurons], sum of its absolute values so far */
} work;

/* see vdna/emd.h */
size_t vdna_emd_scratch_size(uint32_t neurons)
{
    const uint64_t size = (uint64_t)neurons * 2 * sizeof(int64_t);
    return size <= SIZE_MAX / 2 ? (size_t)size : 0;
}

/* see span.h */
vdna_status vdna_check_scratch(uint32_t neurons, const void *scratch, size_t scratch_size)
{
    if (!scratch || (uintptr_t)scratch % sizeof(int64_t) != 0)
        return VDNA_ERR_ARG;
    const size_t needed = vdna_emd_scratch_size(neurons);
    if (needed == 0 || scratch_size < needed)
        return VDNA_ERR_NOMEM;
    return VDNA_OK;
}

/* see span.h */
vdna_status vdna_check_pair(const vdna_hist_view *p, const vdna_hist_view *q, const void *scratch,
                            size_t scratch_size)
{
    const vdna_status status = vdna_hist_view_check_pair(p, q);
    if (status != VDNA_OK)
        return status;
    return vdna_check_scratch(p->neurons, scratch, scratch_size);
}

/* For the proofs of add_row() and add_narrow_row() in test/hostile/proof. `moved` is the amount
 * that a bin adds to the running difference; sum_span() has checked the bound that makes everything
 * fit. */
/*@ lemma product: \forall integer x, y; 0 <= x <= UINT32_MAX && 0 <= y <= UINT32_MAX ==>
      0 <= x * y <= UINT64_MAX;
    predicate fits(integer difference, integer sum, integer moved) =
      -INT64_MAX <= moved <= INT64_MAX && -INT64_MAX <= difference + moved <= INT64_MAX &&
      0 <= sum && sum + \abs(difference + moved) <= INT64_MAX;
    predicate fits_narrow(integer difference, integer sum, integer moved_p, integer moved_q) =
      0 <= moved_p <= INT32_MAX && 0 <= moved_q <= INT32_MAX &&
      -INT32_MAX <= difference + moved_p - moved_q && difference + moved_p <= INT32_MAX &&
      0 <= sum && sum + \abs(difference + moved_p - moved_q) <= INT32_MAX; */

/*@ requires \valid_read(row_p + (0 .. neurons - 1)) && \valid_read(row_q + (0 .. neurons - 1));
    requires \valid(difference + (0 .. neurons - 1)) && \valid(sum + (0 .. neurons - 1));
    requires \separated(row_p + (0 .. neurons - 1), difference + (0 .. neurons - 1),
      sum + (0 .. neurons - 1));
    requires \separated(row_q + (0 .. neurons - 1), difference + (0 .. neurons - 1),
      sum + (0 .. neurons - 1));
    requires \forall integer n; 0 <= n < neurons ==>
      fits(difference[n], sum[n], row_p[n] * scale_p - row_q[n] * scale_q);
    assigns difference[0 .. neurons - 1], sum[0 .. neurons - 1];
    ensures \forall integer n; 0 <= n < neurons ==>
      difference[n] == \old(difference[n]) + row_p[n] * scale_p - row_q[n] * scale_q;
    ensures \forall integer n; 0 <= n < neurons ==>
      sum[n] == \old(sum[n]) + \abs(difference[n]); */
VDNA_VECTORISED static void add_row(const uint32_t *restrict row_p, const uint32_t *restrict row_q,
                                    uint32_t scale_p, uint32_t scale_q, size_t neurons,
                                    int64_t *restrict difference, int64_t *restrict sum)
{
    /*@ loop invariant 0 <= n <= neurons;
        loop invariant \forall integer i; n <= i < neurons ==>
          difference[i] == \at(difference[i], Pre);
        loop invariant \forall integer i; n <= i < neurons ==> sum[i] == \at(sum[i], Pre);
        loop invariant \forall integer i; 0 <= i < n ==> difference[i] ==
          \at(difference[i], Pre) + row_p[i] * scale_p - row_q[i] * scale_q;
        loop invariant \forall integer i; 0 <= i < n ==>
          sum[i] == \at(sum[i], Pre) + \abs(difference[i]);
        loop assigns n, difference[0 .. neurons - 1], sum[0 .. neurons - 1];
        loop variant neurons - n; */
    for (size_t n = 0; n < neurons; n++) {
        const uint64_t moved_p = (uint64_t)row_p[n] * scale_p;
        const uint64_t moved_q = (uint64_t)row_q[n] * scale_q;
        /*@ assert moved_p == row_p[n] * scale_p && moved_q == row_q[n] * scale_q; */
        /*@ assert fits(difference[n], sum[n], moved_p - moved_q); */
        /*@ assert (int64_t)(moved_p - moved_q) == moved_p - moved_q; */
        const int64_t d = difference[n] + (int64_t)(moved_p - moved_q);
        difference[n] = d;
        sum[n] += d < 0 ? -d : d;
    }
}

/* add_row() for numbers that fit 32 bits: twice as many neurons in a vector. */
/*@ requires \valid_read(row_p + (0 .. neurons - 1)) && \valid_read(row_q + (0 .. neurons - 1));
    requires \valid(difference + (0 .. neurons - 1)) && \valid(sum + (0 .. neurons - 1));
    requires \separated(row_p + (0 .. neurons - 1), difference + (0 .. neurons - 1),
      sum + (0 .. neurons - 1));
    requires \separated(row_q + (0 .. neurons - 1), difference + (0 .. neurons - 1),
      sum + (0 .. neurons - 1));
    requires \forall integer n; 0 <= n < neurons ==>
      fits_narrow(difference[n], sum[n], row_p[n] * scale_p, row_q[n] * scale_q);
    assigns difference[0 .. neurons - 1], sum[0 .. neurons - 1];
    ensures \forall integer n; 0 <= n < neurons ==>
      difference[n] == \old(difference[n]) + row_p[n] * scale_p - row_q[n] * scale_q;
    ensures \forall integer n; 0 <= n < neurons ==>
      sum[n] == \old(sum[n]) + \abs(difference[n]); */
VDNA_VECTORISED static void add_narrow_row(const uint32_t *restrict row_p,
                                           const uint32_t *restrict row_q, uint32_t scale_p,
                                           uint32_t scale_q, size_t neurons,
                                           int32_t *restrict difference, int32_t *restrict sum)
{
    /*@ loop invariant 0 <= n <= neurons;
        loop invariant \forall integer i; n <= i < neurons ==>
          difference[i] == \at(difference[i], Pre);
        loop invariant \forall integer i; n <= i < neurons ==> sum[i] == \at(sum[i], Pre);
        loop invariant \forall integer i; 0 <= i < n ==> difference[i] ==
          \at(difference[i], Pre) + row_p[i] * scale_p - row_q[i] * scale_q;
        loop invariant \forall integer i; 0 <= i < n ==>
          sum[i] == \at(sum[i], Pre) + \abs(difference[i]);
        loop assigns n, difference[0 .. neurons - 1], sum[0 .. neurons - 1];
        loop variant neurons - n; */
    for (size_t n = 0; n < neurons; n++) {
        const int32_t d =
            difference[n] + (int32_t)(row_p[n] * scale_p) - (int32_t)(row_q[n] * scale_q);
        difference[n] = d;
        sum[n] += d < 0 ? -d : d;
    }
}

/* The exact sums of a span. Row by row: each row is one vectorised pass over memory. The last bin
 * adds nothing to a sum, because both cumulative histograms end at 1. */
static void sum_rows(const vdna_hist_view *p, const vdna_hist_view *q, const vdna_span *s,
                     const work *w)
{
    memset(w->difference, 0, s->count * sizeof *w->difference);
    memset(w->sum, 0, s->count * sizeof *w->sum);
    for (size_t b = 0, at = s->first; b + 1 < p->bins; b++, at += p->neurons)
        add_row(p->counts + at, q->counts + at, s->scale_p, s->scale_q, s->count, w->difference,
                w->sum);
}

/* sum_rows() in 32 bits, inside the memory of the 64-bit differences; the sums are widened at the
 * end. */
static void sum_narrow_rows(const vdna_hist_view *p, const vdna_hist_view *q, const vdna_span *s,
                            const work *w)
{
    int32_t *const difference = (int32_t *)(void *)w->difference;
    int32_t *const sum = difference + s->count;
    memset(w->difference, 0, s->count * sizeof *w->difference);
    for (size_t b = 0, at = s->first; b + 1 < p->bins; b++, at += p->neurons)
        add_narrow_row(p->counts + at, q->counts + at, s->scale_p, s->scale_q, s->count, difference,
                       sum);
    for (size_t n = 0; n < s->count; n++)
        w->sum[n] = sum[n];
}

/* A running difference never exceeds the common mass, a sum never that mass times its bins. */
static vdna_status sum_span(const vdna_hist_view *p, const vdna_hist_view *q, const vdna_span *s,
                            const work *w)
{
    const uint64_t terms = p->bins - 1;
    if (s->mass > INT64_MAX / terms)
        return VDNA_ERR_OVERFLOW;
    if (s->mass <= INT32_MAX / terms)
        sum_narrow_rows(p, q, s, w);
    else
        sum_rows(p, q, s, w);
    return VDNA_OK;
}

/* The distances of all neurons, and their sum.
 * @param out_emd_bins  [neurons], or NULL */
static vdna_status distances(const vdna_hist_view *p, const vdna_hist_view *q, void *scratch,
                             size_t scratch_size, double *out_emd_bins, double *out_total)
{
    vdna_status status = vdna_check_pair(p, q, scratch, scratch_size);
    if (status != VDNA_OK)
        return status;
    const work w = {scratch, (int64_t *)scratch + p->neurons};
    double total = 0;
    for (size_t first = 0; first < p->neurons;) {
        const vdna_span s = vdna_span_from(p->mass, q->mass, p->neurons, first);
        status = sum_span(p, q, &s, &w);
        if (status != VDNA_OK)
            return status;
        for (size_t n = 0; n < s.count; n++) {
            const double emd = vdna_quotient((uint64_t)w.sum[n], s.mass);
            if (out_emd_bins)
                out_emd_bins[first + n] = emd;
            total += emd;
        }
        first += s.count;
    }
    *out_total = total;
    return VDNA_OK;
}

/* see vdna/emd.h */
vdna_status vdna_emd(const vdna_hist_view *p, const vdna_hist_view *q, void *scratch,
                     size_t scratch_size, double *out_emd_bins)
{
    double total;
    if (!out_emd_bins)
        return VDNA_ERR_ARG;
    return distances(p, q, scratch, scratch_size, out_emd_bins, &total);
}

/* see vdna/emd.h */
vdna_status vdna_emd_mean(const vdna_hist_view *p, const vdna_hist_view *q, void *scratch,
                          size_t scratch_size, double *out_distance_bins)
{
    if (!out_distance_bins)
        return VDNA_ERR_ARG;
    double total;
    const vdna_status status = distances(p, q, scratch, scratch_size, NULL, &total);
    if (status == VDNA_OK)
        *out_distance_bins = total / p->neurons;
    return status;
}
