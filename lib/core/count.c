#include "count.h"
#include "vectorised.h"

/* The definition to the letter: half-open bins, the last closed. */
static uint32_t slot_of(const vdna_hist *hist, size_t neuron, float value)
{
    const double lo = hist->range[2 * neuron], hi = hist->range[2 * neuron + 1];
    const double mid = (lo + hi) / 2, half = (hi - lo) / 2, bins = hist->bins;
    const double x = (value - mid) / half;
    if (x < -1)
        return hist->bins + SLOT_BELOW;
    if (x > 1)
        return hist->bins + SLOT_ABOVE;
    /* x + 1 is not negative, so the conversion is the floor. */
    const uint32_t bin = (uint32_t)((x + 1) * bins / 2);
    return bin < hist->bins ? bin : hist->bins - 1;
}

/* The bin of a slot: samples beyond the range land in an edge bin. */
static uint32_t bin_of(const vdna_hist *hist, uint32_t slot)
{
    if (slot < hist->bins)
        return slot;
    return slot == hist->bins + SLOT_BELOW ? 0 : hist->bins - 1;
}

/* Slots are estimated in single precision, several values at a time, which vectorises. Where that
 * does not make the bin certain, because an edge is near or the value beyond the range, the slot is
 * UNSURE and the definition decides. */
#define UNSURE UINT32_MAX
enum { AT_A_TIME = sizeof(void *) > 4 ? 128 : 32 }; /* a microcontroller's stack is small */

/* The line from a value to its place among the bins, for the neuron of each lane. */
typedef struct lines {
    float lo[AT_A_TIME], scale[AT_A_TIME];
} lines;

/* Put the line of one neuron into a lane. Where the width or the scale leaves the floats, the
 * scale is infinite or 0, with which no place is sure. */
static inline void draw_line(const vdna_hist *hist, size_t neuron, lines *l, size_t lane)
{
    const float lo = hist->range[2 * neuron], hi = hist->range[2 * neuron + 1];
    l->lo[lane] = lo;
    l->scale[lane] = (float)hist->bins / (hi - lo);
}

static inline void estimate_slots(const lines *l, uint32_t bins, const float *values, size_t count,
                                  uint32_t *out_slots)
{
    /* Difference, width, scale and product each round by at most 2^-24 of at most `bins`, a
     * subnormal scale by twice that; eight roundings are allowed for. Those of the definition, in
     * double, are far smaller. */
    const float sure = 0.5f - (float)bins / 2097152;
    /* Below 0 and from `bins` on nothing is sure; this only keeps the conversion defined. */
    const float least = -1, most = (float)bins;
    for (size_t i = 0; i < count; i++) {
        float place = (values[i] - l->lo[i]) * l->scale[i];
        place = place > least ? place : least; /* first, because it also ends a NaN */
        place = place < most ? place : most;
        const int32_t bin = (int32_t)place;
        const float from_middle = place - (float)bin - 0.5f;
        const int is_sure = (from_middle <= sure) & (from_middle >= -sure);
        out_slots[i] = is_sure ? (uint32_t)bin : UNSURE;
    }
}

/* Count values whose neurons are `step` (0 or 1) apart, and make the unsure slots sure. */
static inline void count_values(vdna_hist *hist, size_t neuron, size_t step, const float *values,
                                size_t count, uint32_t *slots)
{
    /* Copies, because the compiler cannot know that counting changes none of them. */
    uint32_t *const counts = hist->counts;
    const size_t neurons = hist->neurons;
    for (size_t i = 0; i < count; i++, neuron += step) {
        uint32_t bin = slots[i];
        if (bin == UNSURE) {
            slots[i] = slot_of(hist, neuron, values[i]);
            hist->saturated[neuron] += slots[i] >= hist->bins;
            bin = bin_of(hist, slots[i]);
        }
        counts[bin * neurons + neuron]++;
    }
}

/* Count one run of neighbours in memory. */
static inline void count_run(vdna_hist *hist, const lines *l, size_t neuron, size_t step,
                             const float *values, size_t count, uint16_t *out_slots)
{
    uint32_t slots[AT_A_TIME];
    estimate_slots(l, hist->bins, values, count, slots);
    count_values(hist, neuron, step, values, count, slots);
    if (out_slots)
        for (size_t i = 0; i < count; i++)
            out_slots[i] = (uint16_t)slots[i];
}

/* Tokens: neighbours in memory are neighbouring neurons. */
VDNA_VECTORISED static void count_tokens(vdna_hist *hist, size_t first, const vdna_activations *tap,
                                         uint16_t *out_slots)
{
    const size_t neurons = tap->neurons;
    lines l;
    for (size_t n = 0; n < neurons; n += AT_A_TIME) {
        const size_t count = neurons - n < AT_A_TIME ? neurons - n : AT_A_TIME;
        for (size_t i = 0; i < count; i++)
            draw_line(hist, first + n + i, &l, i);
        for (size_t i = n; i < neurons * tap->samples; i += neurons) {
            count_run(hist, &l, first + n, 1, tap->values + i, count,
                      out_slots ? out_slots + i : NULL);
        }
    }
}

/* A feature map: neighbours in memory are samples of one neuron. */
VDNA_VECTORISED static void count_map(vdna_hist *hist, size_t first, const vdna_activations *tap,
                                      uint16_t *out_slots)
{
    const size_t samples = tap->samples;
    lines l;
    for (size_t n = 0; n < tap->neurons; n++) {
        for (size_t i = 0; i < AT_A_TIME; i++)
            draw_line(hist, first + n, &l, i);
        for (size_t i = n * samples; i < (n + 1) * samples; i += AT_A_TIME) {
            const size_t left = (n + 1) * samples - i, count = left < AT_A_TIME ? left : AT_A_TIME;
            count_run(hist, &l, first + n, 0, tap->values + i, count,
                      out_slots ? out_slots + i : NULL);
        }
    }
}

/* Count one tap, whose first neuron is `first`. One sample of each neuron is either layout. */
static void count_tap(vdna_hist *hist, size_t first, const vdna_activations *tap,
                      uint16_t *out_slots)
{
    if (tap->layout == VDNA_LAYOUT_SAMPLES_NEURONS || tap->samples == 1)
        count_tokens(hist, first, tap, out_slots);
    else
        count_map(hist, first, tap, out_slots);
    for (size_t n = 0; n < tap->neurons; n++)
        hist->mass[first + n] += tap->samples;
}

/* see count.h */
void vdna_count_frame(vdna_hist *hist, const vdna_activations *taps, size_t tap_count,
                      uint16_t *out_slots)
{
    size_t first = 0;
    for (size_t t = 0; t < tap_count; t++) {
        count_tap(hist, first, &taps[t], out_slots);
        first += taps[t].neurons;
        if (out_slots)
            out_slots += (size_t)taps[t].neurons * taps[t].samples;
    }
    hist->frames++;
}

static void uncount_tap(vdna_hist *hist, size_t first, const vdna_activations *tap,
                        const uint16_t *slots)
{
    const int tokens = tap->layout == VDNA_LAYOUT_SAMPLES_NEURONS;
    const size_t neuron_step = tokens ? 1 : tap->samples, sample_step = tokens ? tap->neurons : 1;
    for (size_t n = 0; n < tap->neurons; n++) {
        for (size_t s = 0; s < tap->samples; s++) {
            const uint32_t slot = slots[n * neuron_step + s * sample_step];
            hist->counts[(size_t)bin_of(hist, slot) * hist->neurons + first + n]--;
            hist->saturated[first + n] -= slot >= hist->bins;
        }
        hist->mass[first + n] -= tap->samples;
    }
}

/* see count.h */
void vdna_uncount_frame(vdna_hist *hist, const vdna_activations *taps, size_t tap_count,
                        const uint16_t *slots)
{
    size_t first = 0;
    for (size_t t = 0; t < tap_count; t++) {
        uncount_tap(hist, first, &taps[t], slots);
        first += taps[t].neurons;
        slots += (size_t)taps[t].neurons * taps[t].samples;
    }
    hist->frames--;
}
