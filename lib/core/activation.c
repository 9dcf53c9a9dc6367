#include <math.h>
#include <vdna/activation.h>

/* Without an early exit, so that the loop vectorises: good frames are the rule. */
static int all_finite(const float *values, size_t count)
{
    int finite = 1;
    for (size_t i = 0; i < count; i++)
        finite &= isfinite(values[i]) ? 1 : 0;
    return finite;
}

/* see vdna/activation.h */
vdna_status vdna_activations_check(const vdna_activations *taps, size_t tap_count, uint32_t neurons)
{
    if (!taps || tap_count == 0)
        return VDNA_ERR_ARG;

    uint64_t total = 0;
    for (size_t t = 0; t < tap_count; t++) {
        if (!taps[t].values || taps[t].neurons == 0 || taps[t].samples == 0 ||
            taps[t].layout > VDNA_LAYOUT_NEURONS_SAMPLES)
            return VDNA_ERR_ARG;
        /* Bounded at each step, so the sum cannot wrap however many taps are claimed. */
        total += taps[t].neurons;
        if (total > neurons)
            return VDNA_ERR_MISMATCH;
    }
    if (total != neurons)
        return VDNA_ERR_MISMATCH;

    for (size_t t = 0; t < tap_count; t++)
        if (!all_finite(taps[t].values, (size_t)taps[t].neurons * taps[t].samples))
            return VDNA_ERR_NONFINITE;
    return VDNA_OK;
}
