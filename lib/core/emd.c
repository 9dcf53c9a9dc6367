#include <string.h>
#include <vdna/emd.h>

#include "vectorised.h"

/* Working memory: per neuron the running difference of the cumulative counts, and its sum. */
typedef struct work {
    int64_t *difference; /* [neurons], cumulative P * mass_q - cumulative Q * mass_p so far */
    int64_t *sum;        /* [neurons], sum of its absolute values so far */
} work;

/* see vdna/emd.h */
size_t vdna_emd_scratch_size(uint32_t neurons)
{
    const uint64_t size = (uint64_t)neurons * 2 * sizeof(int64_t);
    return size <= SIZE_MAX / 2 ? (size_t)size : 0;
}

/* No running difference is larger than this, as an absolute value. */
static uint64_t largest_product(const vdna_hist_view *p, const vdna_hist_view *q)
{
    uint64_t largest = 0;
    for (size_t n = 0; n < p->neurons; n++) {
        const uint64_t product = (uint64_t)p->mass[n] * q->mass[n];
        largest = product > largest ? product : largest;
    }
    return largest;
}

static vdna_status check_arguments(const vdna_hist_view *p, const vdna_hist_view *q,
                                   const void *scratch, size_t scratch_size)
{
    if (!scratch || (uintptr_t)scratch % sizeof(int64_t) != 0)
        return VDNA_ERR_ARG;
    const vdna_status status = vdna_hist_view_check_pair(p, q);
    if (status != VDNA_OK)
        return status;
    const size_t needed = vdna_emd_scratch_size(p->neurons);
    if (needed == 0 || scratch_size < needed)
        return VDNA_ERR_NOMEM;
    return VDNA_OK;
}

/* For the proof of add_row() in test/proof. `moved` is what a bin adds to the running difference;
 * that all of it fits is the bound which was checked before. */
/*@ lemma product: \forall integer x, y; 0 <= x <= UINT32_MAX && 0 <= y <= UINT32_MAX ==>
      0 <= x * y <= UINT64_MAX;
    predicate fits(integer difference, integer sum, integer moved) =
      -INT64_MAX <= moved <= INT64_MAX && -INT64_MAX <= difference + moved <= INT64_MAX &&
      0 <= sum && sum + \abs(difference + moved) <= INT64_MAX; */

/*@ requires \valid_read(row_p + (0 .. neurons - 1)) && \valid_read(row_q + (0 .. neurons - 1));
    requires \valid_read(mass_p + (0 .. neurons - 1)) && \valid_read(mass_q + (0 .. neurons - 1));
    requires \valid(difference + (0 .. neurons - 1)) && \valid(sum + (0 .. neurons - 1));
    requires \separated(difference + (0 .. neurons - 1), sum + (0 .. neurons - 1));
    requires \forall integer n; 0 <= n < neurons ==>
      fits(difference[n], sum[n], row_p[n] * mass_q[n] - row_q[n] * mass_p[n]);
    assigns difference[0 .. neurons - 1], sum[0 .. neurons - 1]; */
VDNA_VECTORISED static void add_row(const uint32_t *restrict row_p, const uint32_t *restrict row_q,
                                    const uint32_t *mass_p, const uint32_t *mass_q, size_t neurons,
                                    int64_t *restrict difference, int64_t *restrict sum)
{
    /*@ loop invariant 0 <= n <= neurons;
        loop invariant \forall integer i; n <= i < neurons ==>
          difference[i] == \at(difference[i], Pre) && sum[i] == \at(sum[i], Pre);
        loop assigns n, difference[0 .. neurons - 1], sum[0 .. neurons - 1];
        loop variant neurons - n; */
    for (size_t n = 0; n < neurons; n++) {
        const uint64_t moved_p = (uint64_t)row_p[n] * mass_q[n];
        const uint64_t moved_q = (uint64_t)row_q[n] * mass_p[n];
        /*@ assert moved_p == row_p[n] * mass_q[n] && moved_q == row_q[n] * mass_p[n]; */
        /*@ assert fits(difference[n], sum[n], moved_p - moved_q); */
        /*@ assert (int64_t)(moved_p - moved_q) == moved_p - moved_q; */
        const int64_t d = difference[n] + (int64_t)(moved_p - moved_q);
        difference[n] = d;
        sum[n] += d < 0 ? -d : d;
    }
}

/* As add_row(), where all of it fits 32 bits: twice as many neurons in a vector. */
VDNA_VECTORISED static void add_narrow_row(const uint32_t *restrict row_p,
                                           const uint32_t *restrict row_q, const uint32_t *mass_p,
                                           const uint32_t *mass_q, size_t neurons,
                                           int32_t *restrict difference, int32_t *restrict sum)
{
    for (size_t n = 0; n < neurons; n++) {
        const int32_t d =
            difference[n] + (int32_t)(row_p[n] * mass_q[n]) - (int32_t)(row_q[n] * mass_p[n]);
        difference[n] = d;
        sum[n] += d < 0 ? -d : d;
    }
}

/* sum_rows() in 32 bits, which lie where the 64-bit differences would, and are then widened. */
static void sum_narrow_rows(const vdna_hist_view *p, const vdna_hist_view *q, const work *w)
{
    const size_t neurons = p->neurons;
    int32_t *const difference = (int32_t *)(void *)w->difference, *const sum = difference + neurons;
    memset(w->difference, 0, neurons * sizeof *w->difference);
    for (size_t b = 0; b + 1 < p->bins; b++)
        add_narrow_row(p->counts + b * neurons, q->counts + b * neurons, p->mass, q->mass, neurons,
                       difference, sum);
    for (size_t n = 0; n < neurons; n++)
        w->sum[n] = sum[n];
}

/* The exact sums of all neurons. Row by row: each row is one pass over memory that vectorises. */
static void sum_rows(const vdna_hist_view *p, const vdna_hist_view *q, const work *w)
{
    const size_t neurons = p->neurons;
    memset(w->difference, 0, neurons * sizeof *w->difference);
    memset(w->sum, 0, neurons * sizeof *w->sum);
    for (size_t b = 0; b + 1 < p->bins; b++)
        add_row(p->counts + b * neurons, q->counts + b * neurons, p->mass, q->mass, neurons,
                w->difference, w->sum);
}

static vdna_status exact_sums(const vdna_hist_view *p, const vdna_hist_view *q, void *scratch,
                              size_t scratch_size, work *out_work)
{
    const vdna_status status = check_arguments(p, q, scratch, scratch_size);
    if (status != VDNA_OK)
        return status;
    /* The last bin adds nothing to a sum, because both cumulative histograms end at 1. */
    const uint64_t largest = largest_product(p, q), terms = p->bins - 1;
    if (largest > INT64_MAX / terms)
        return VDNA_ERR_OVERFLOW;
    out_work->difference = scratch;
    out_work->sum = out_work->difference + p->neurons;
    if (largest <= INT32_MAX / terms)
        sum_narrow_rows(p, q, out_work);
    else
        sum_rows(p, q, out_work);
    return VDNA_OK;
}

/* Up to here integers are doubles without rounding. */
#define EXACT_DOUBLES ((uint64_t)1 << 53)

/* sum / mass rounded to nearest: by long division to 55 bits, of which the last one says whether
 * anything lies below, so that only the conversion to double rounds. mass is below 2^63. */
static double long_quotient(uint64_t sum, uint64_t mass)
{
    uint64_t whole = sum / mass, rest = sum % mass;
    double unit = 1;
    for (; whole < 2 * EXACT_DOUBLES; unit /= 2) {
        const uint64_t bit = 2 * rest >= mass;
        whole = 2 * whole + bit;
        rest = 2 * rest - bit * mass;
    }
    return (double)(whole | (rest != 0)) * unit;
}

/* The distance of one neuron: the fraction, rounded once. */
static double emd_of(const vdna_hist_view *p, const vdna_hist_view *q, const work *w, size_t n)
{
    const uint64_t mass = (uint64_t)p->mass[n] * q->mass[n], sum = (uint64_t)w->sum[n];
    if (sum == 0 || (sum < EXACT_DOUBLES && mass < EXACT_DOUBLES))
        return (double)sum / (double)mass;
    return long_quotient(sum, mass);
}

/* see vdna/emd.h */
vdna_status vdna_emd(const vdna_hist_view *p, const vdna_hist_view *q, void *scratch,
                     size_t scratch_size, double *out_emd_bins)
{
    if (!out_emd_bins)
        return VDNA_ERR_ARG;
    work w;
    const vdna_status status = exact_sums(p, q, scratch, scratch_size, &w);
    if (status != VDNA_OK)
        return status;
    for (size_t n = 0; n < p->neurons; n++)
        out_emd_bins[n] = emd_of(p, q, &w, n);
    return VDNA_OK;
}

/* see vdna/emd.h */
vdna_status vdna_emd_mean(const vdna_hist_view *p, const vdna_hist_view *q, void *scratch,
                          size_t scratch_size, double *out_distance_bins)
{
    if (!out_distance_bins)
        return VDNA_ERR_ARG;
    work w;
    const vdna_status status = exact_sums(p, q, scratch, scratch_size, &w);
    if (status != VDNA_OK)
        return status;
    double total = 0;
    for (size_t n = 0; n < p->neurons; n++)
        total += emd_of(p, q, &w, n);
    *out_distance_bins = total / p->neurons;
    return VDNA_OK;
}
