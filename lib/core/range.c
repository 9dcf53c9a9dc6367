#include <math.h>

#include <vdna/range.h>

/* Half-width of a neuron that never varied, in activation units. */
#define CONSTANT_NEURON_HALF_WIDTH 1.0

/* see vdna/range.h */
vdna_status vdna_range_check(const float *range, uint32_t neurons)
{
    if (!range || neurons == 0)
        return VDNA_ERR_ARG;
    for (size_t n = 0; n < neurons; n++) {
        const float lo = range[2 * n], hi = range[2 * n + 1];
        if (!isfinite(lo) || !isfinite(hi) || !(lo < hi))
            return VDNA_ERR_ARG;
    }
    return VDNA_OK;
}

/* see vdna/range.h */
vdna_status vdna_range_clear(float *range, uint32_t neurons)
{
    if (!range || neurons == 0)
        return VDNA_ERR_ARG;
    for (size_t n = 0; n < neurons; n++) {
        range[2 * n] = INFINITY;
        range[2 * n + 1] = -INFINITY;
    }
    return VDNA_OK;
}

static void observe_one(float *lo_hi, float value)
{
    if (value < lo_hi[0])
        lo_hi[0] = value;
    if (value > lo_hi[1])
        lo_hi[1] = value;
}

static void observe_tap(float *range, const vdna_activations *tap)
{
    const size_t neurons = tap->neurons, samples = tap->samples;
    if (tap->layout == VDNA_LAYOUT_SAMPLES_NEURONS) {
        for (size_t s = 0; s < samples; s++)
            for (size_t n = 0; n < neurons; n++)
                observe_one(range + 2 * n, tap->values[s * neurons + n]);
    } else {
        for (size_t n = 0; n < neurons; n++)
            for (size_t s = 0; s < samples; s++)
                observe_one(range + 2 * n, tap->values[n * samples + s]);
    }
}

/* see vdna/range.h */
vdna_status vdna_range_observe(float *range, uint32_t neurons, const vdna_activations *taps,
                               size_t tap_count)
{
    if (!range)
        return VDNA_ERR_ARG;
    const vdna_status status = vdna_activations_check(taps, tap_count, neurons);
    if (status != VDNA_OK)
        return status;

    for (size_t t = 0; t < tap_count; t++) {
        observe_tap(range, &taps[t]);
        range += 2 * (size_t)taps[t].neurons;
    }
    return VDNA_OK;
}

/* The widened edges of one neuron, in double, so that an edge is rounded only once. */
static void expanded(const float *lo_hi, double factor, uint32_t rule, double *out_lo,
                     double *out_hi)
{
    const double lo = lo_hi[0], hi = lo_hi[1];
    const double mid = (lo + hi) / 2, half = (hi - lo) / 2;
    if (half == 0) {
        *out_lo = mid - CONSTANT_NEURON_HALF_WIDTH;
        *out_hi = mid + CONSTANT_NEURON_HALF_WIDTH;
    } else if (rule == VDNA_RANGE_ABOUT_ZERO) {
        *out_lo = lo * factor;
        *out_hi = hi * factor;
    } else {
        *out_lo = mid - half * factor;
        *out_hi = mid + half * factor;
    }
}

/* see vdna/range.h */
vdna_status vdna_range_expand(float *range, uint32_t neurons, float factor, uint32_t rule)
{
    if (!range || neurons == 0 || !isfinite(factor) || factor < 1 || rule > VDNA_RANGE_ABOUT_ZERO)
        return VDNA_ERR_ARG;

    double lo, hi;
    for (size_t n = 0; n < neurons; n++) {
        if (!(range[2 * n] <= range[2 * n + 1]))
            return VDNA_ERR_EMPTY;
        expanded(range + 2 * n, factor, rule, &lo, &hi);
        /* A huge constant neuron can swallow its half-width: lo < hi must hold as floats. */
        if (!isfinite((float)lo) || !isfinite((float)hi) || !((float)lo < (float)hi))
            return VDNA_ERR_NONFINITE;
    }

    for (size_t n = 0; n < neurons; n++) {
        expanded(range + 2 * n, factor, rule, &lo, &hi);
        range[2 * n] = (float)lo;
        range[2 * n + 1] = (float)hi;
    }
    return VDNA_OK;
}
