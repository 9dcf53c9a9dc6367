#include <math.h>

#include "shape.h"
#include "vectorised.h"

/* see shape.h */
vdna_status vdna_taps_shape(const vdna_activations *taps, size_t tap_count, uint32_t *out_neurons)
{
    if (!taps || tap_count == 0)
        return VDNA_ERR_ARG;
    uint32_t neurons = 0;
    for (size_t t = 0; t < tap_count; t++) {
        if (taps[t].neurons == 0 || taps[t].samples == 0 ||
            taps[t].layout > VDNA_LAYOUT_NEURONS_SAMPLES ||
            taps[t].samples > SIZE_MAX / sizeof(float) / taps[t].neurons)
            return VDNA_ERR_ARG;
        if (taps[t].neurons > UINT32_MAX - neurons)
            return VDNA_ERR_MISMATCH;
        neurons += taps[t].neurons;
    }
    *out_neurons = neurons;
    return VDNA_OK;
}

/* No early exit, so that the loop vectorises: good frames are the rule. */
VDNA_VECTORISED static int all_finite(const float *values, size_t count)
{
    int finite = 1;
    for (size_t i = 0; i < count; i++)
        finite &= isfinite(values[i]) ? 1 : 0;
    return finite;
}

/* see vdna/activation.h */
vdna_status vdna_activations_check(const vdna_activations *taps, size_t tap_count, uint32_t neurons)
{
    uint32_t total;
    const vdna_status status = vdna_taps_shape(taps, tap_count, &total);
    if (status != VDNA_OK)
        return status;
    for (size_t t = 0; t < tap_count; t++)
        if (!taps[t].values)
            return VDNA_ERR_ARG;
    if (total != neurons)
        return VDNA_ERR_MISMATCH;

    for (size_t t = 0; t < tap_count; t++)
        if (!all_finite(taps[t].values, (size_t)taps[t].neurons * taps[t].samples))
            return VDNA_ERR_NONFINITE;
    return VDNA_OK;
}
