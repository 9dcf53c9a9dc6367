#include <math.h>

#include <vdna/explain.h>
#include <vdna/int8.h>

/* What one neuron adds. */
static vdna_reason neuron_share(const double *winner_emd_bins, const double *against_emd_bins,
                                uint32_t neurons, uint32_t neuron)
{
    const double winner = winner_emd_bins[neuron], against = against_emd_bins[neuron];
    const vdna_reason reason = {winner / neurons, against / neurons, (against - winner) / neurons,
                                neuron, 1};
    return reason;
}

/* see vdna/explain.h */
vdna_status vdna_explain_sum(const double *winner_emd_bins, const double *against_emd_bins,
                             uint32_t neurons, uint32_t first, uint32_t count, vdna_reason *out_sum)
{
    if (!winner_emd_bins || !against_emd_bins || count == 0 || count > neurons ||
        first > neurons - count || !out_sum)
        return VDNA_ERR_ARG;

    vdna_reason sum = {0, 0, 0, first, count};
    for (uint32_t i = 0; i < count; i++) {
        const vdna_reason one = neuron_share(winner_emd_bins, against_emd_bins, neurons, first + i);
        sum.winner_bins += one.winner_bins;
        sum.against_bins += one.against_bins;
        sum.margin_bins += one.margin_bins;
    }
    *out_sum = sum;
    return VDNA_OK;
}

static double magnitude_of(const vdna_reason *reason)
{
    return reason->margin_bins < 0 ? -reason->margin_bins : reason->margin_bins;
}

/* Put a reason where it belongs among the `count` before it, for which there is `room`. */
static void insert_reason(vdna_reason *reasons, uint32_t count, uint32_t room,
                          const vdna_reason *reason)
{
    uint32_t at = count;
    for (; at > 0 && magnitude_of(&reasons[at - 1]) < magnitude_of(reason); at--)
        if (at < room)
            reasons[at] = reasons[at - 1];
    if (at < room)
        reasons[at] = *reason;
}

/* see vdna/explain.h */
vdna_status vdna_explain_top(const double *winner_emd_bins, const double *against_emd_bins,
                             uint32_t neurons, uint32_t wanted, vdna_reason *out_reasons)
{
    if (!winner_emd_bins || !against_emd_bins || wanted == 0 || wanted > neurons || !out_reasons)
        return VDNA_ERR_ARG;
    for (uint32_t n = 0; n < neurons; n++)
        if (!isfinite(winner_emd_bins[n]) || !isfinite(against_emd_bins[n]))
            return VDNA_ERR_NONFINITE;

    for (uint32_t n = 0; n < neurons; n++) {
        const vdna_reason reason = neuron_share(winner_emd_bins, against_emd_bins, neurons, n);
        insert_reason(out_reasons, n < wanted ? n : wanted, wanted, &reason);
    }
    return VDNA_OK;
}

/* A neuron in each frame of an experience. */
typedef struct vdna_coded_neuron {
    const int8_t *codes; /* [frames][neurons] */
    const float *scale;  /* [frames] */
    size_t neurons, neuron;
} vdna_coded_neuron;

static float value_in(const vdna_coded_neuron *coded, uint32_t frame)
{
    float value = 0;
    vdna_int8_decode(coded->codes + frame * coded->neurons + coded->neuron, 1, coded->scale[frame],
                     &value); /* cannot fail */
    return value;
}

static uint32_t frames_apart(uint32_t a, uint32_t b)
{
    return a < b ? b - a : a - b;
}

/* see vdna/explain.h */
vdna_status vdna_explain_frames(const int8_t *codes, const float *scale, uint32_t frames,
                                uint32_t neurons, uint32_t neuron, uint32_t *out_most,
                                uint32_t *out_least)
{
    if (!codes || !scale || frames == 0 || neuron >= neurons || !out_most || !out_least)
        return VDNA_ERR_ARG;

    const vdna_coded_neuron coded = {codes, scale, neurons, neuron};
    uint32_t most = 0, least = 0;
    float highest = value_in(&coded, 0), lowest = highest;
    for (uint32_t f = 1; f < frames; f++) {
        const float value = value_in(&coded, f);
        if (value > highest) {
            highest = value;
            most = f;
        }
    }
    for (uint32_t f = 1; f < frames; f++) {
        const float value = value_in(&coded, f);
        if (value < lowest ||
            (value == lowest && frames_apart(f, most) > frames_apart(least, most))) {
            lowest = value;
            least = f;
        }
    }
    *out_most = most;
    *out_least = least;
    return VDNA_OK;
}
