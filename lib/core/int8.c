#include <math.h>

#include <vdna/int8.h>

#define CODE_MAX 127

/* The largest float that 127 times itself does not make infinite: the one below FLT_MAX / 127. */
#define SCALE_MAX 0x1.020406p+121f

static int8_t code_of(float value, float scale)
{
    const double steps = (double)value / (double)scale;
    const int code = (int)(steps < 0 ? steps - 0.5 : steps + 0.5);
    /* A scale near the smallest float is so coarsely rounded that a quotient may be larger. */
    return (int8_t)(code > CODE_MAX ? CODE_MAX : code < -CODE_MAX ? -CODE_MAX : code);
}

/* see vdna/int8.h */
vdna_status vdna_int8_encode(const float *values, size_t count, int8_t *out_codes, float *out_scale)
{
    if (!values || count == 0 || !out_codes || !out_scale)
        return VDNA_ERR_ARG;
    float largest = 0;
    for (size_t i = 0; i < count; i++) {
        const float magnitude = values[i] < 0 ? -values[i] : values[i];
        if (!isfinite(magnitude))
            return VDNA_ERR_NONFINITE;
        largest = magnitude > largest ? magnitude : largest;
    }

    const float rounded = (float)((double)largest / CODE_MAX);
    const float scale = rounded > SCALE_MAX ? SCALE_MAX : rounded;
    for (size_t i = 0; i < count; i++)
        out_codes[i] = scale > 0 ? code_of(values[i], scale) : 0;
    *out_scale = scale;
    return VDNA_OK;
}

/* see vdna/int8.h */
vdna_status vdna_int8_decode(const int8_t *codes, size_t count, float scale, float *out_values)
{
    if (!codes || count == 0 || !out_values)
        return VDNA_ERR_ARG;
    for (size_t i = 0; i < count; i++)
        out_values[i] = (float)codes[i] * scale;
    return VDNA_OK;
}
