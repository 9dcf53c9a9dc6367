#include <cmath>

#include <vdna/baseline.h>

static double mean_of(const float *values, uint32_t count)
{
    double sum = 0;
    for (uint32_t i = 0; i < count; i++)
        sum += values[i];
    return sum / count;
}

// see vdna/baseline.h
vdna_status vdna_intensity(const float *a, uint32_t frames_a, const float *b, uint32_t frames_b,
                           double *out_distance)
{
    if (!a || frames_a == 0 || !b || frames_b == 0 || !out_distance)
        return VDNA_ERR_ARG;
    const double distance = std::fabs(mean_of(a, frames_a) - mean_of(b, frames_b));
    if (!std::isfinite(distance))
        return VDNA_ERR_NONFINITE;
    *out_distance = distance;
    return VDNA_OK;
}
