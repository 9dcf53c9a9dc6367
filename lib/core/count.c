#include "count.h"
#include "vectorised.h"

/* Neighbouring neurons are counted together, so that all but the counting itself vectorises. */
enum { AT_A_TIME = sizeof(void *) > 4 ? 128 : 8 }; /* a microcontroller's stack is small */

/* The range of the neuron in each lane. */
typedef struct axes {
    double mid[AT_A_TIME], half[AT_A_TIME]; /* the middle, and half the width */
} axes;

/* Put the range of a neuron into a lane. */
static inline void set_axis(const vdna_hist *hist, size_t neuron, axes *a, size_t lane)
{
    const double lo = hist->range[2 * neuron], hi = hist->range[2 * neuron + 1];
    a->mid[lane] = (lo + hi) / 2;
    a->half[lane] = (hi - lo) / 2;
}

/* The definition to the letter: half-open bins, the last closed. A value beyond the range goes the
 * way of all others, to the edge bin, and on to its slot: no branch, and no time that depends on
 * it. */
static inline uint32_t slot_of(float value, double mid, double half, uint32_t bins)
{
    const double x = (value - mid) / half;
    const double place = (x + 1) * bins / 2, last = bins - 1;
    const double not_above = place < last ? place : last;
    const double within = not_above > 0 ? not_above : 0;
    const double to_below = bins + SLOT_BELOW, to_above = 1 + SLOT_ABOVE;
    const double on = x > 1 ? to_above : x < -1 ? to_below : 0;
    /* The conversion is the floor, because nothing is negative; vectors of x86-64 have it to
     * int32_t only. */
    return (uint32_t)(int32_t)(within + on);
}

/* The bin of a slot: samples beyond the range land in an edge bin. */
static inline uint32_t bin_of(uint32_t slot, uint32_t bins)
{
    const uint32_t or_last = slot < bins ? slot : bins - 1;
    return slot == bins + SLOT_BELOW ? 0 : or_last;
}

/* Count a row: a sample of each of `count` neighbouring neurons. */
static inline void count_row(vdna_hist *hist, const axes *a, size_t neuron, const float *values,
                             size_t count, uint16_t *out_slots)
{
    /* Copies, because the compiler cannot know that counting changes none of them. */
    uint32_t *const counts = hist->counts + neuron, *const saturated = hist->saturated + neuron;
    const size_t neurons = hist->neurons;
    const uint32_t bins = hist->bins;
    uint32_t slots[AT_A_TIME], bin[AT_A_TIME];
    for (size_t i = 0; i < count; i++)
        slots[i] = slot_of(values[i], a->mid[i], a->half[i], bins);
    for (size_t i = 0; i < count; i++) {
        bin[i] = bin_of(slots[i], bins);
        saturated[i] += slots[i] >= bins;
    }
    for (size_t i = 0; i < count; i++)
        counts[bin[i] * neurons + i]++;
    if (out_slots)
        for (size_t i = 0; i < count; i++)
            out_slots[i] = (uint16_t)slots[i];
}

/* Count one tap, whose first neuron is `first`. */
VDNA_VECTORISED static void count_tap(vdna_hist *hist, size_t first, const vdna_activations *tap,
                                      uint16_t *out_slots)
{
    const size_t neurons = tap->neurons, samples = tap->samples;
    const int tokens = tap->layout == VDNA_LAYOUT_SAMPLES_NEURONS;
    const size_t neuron_step = tokens ? 1 : samples, sample_step = tokens ? neurons : 1;
    axes a;
    float row[AT_A_TIME];
    for (size_t n = 0; n < neurons; n += AT_A_TIME) {
        const size_t count = neurons - n < AT_A_TIME ? neurons - n : AT_A_TIME;
        for (size_t i = 0; i < count; i++)
            set_axis(hist, first + n + i, &a, i);
        for (size_t s = 0; s < samples; s++) {
            const float *values = tap->values + n * neuron_step + s * sample_step;
            if (neuron_step != 1) {
                for (size_t i = 0; i < count; i++)
                    row[i] = values[i * neuron_step];
                values = row;
            }
            count_row(hist, &a, first + n, values, count,
                      out_slots ? out_slots + s * neurons + n : NULL);
        }
    }
    for (size_t n = 0; n < neurons; n++)
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
    for (size_t s = 0; s < tap->samples; s++) {
        for (size_t n = first; n < first + tap->neurons; n++) {
            const uint32_t slot = *slots++;
            hist->counts[(size_t)bin_of(slot, hist->bins) * hist->neurons + n]--;
            hist->saturated[n] -= slot >= hist->bins;
        }
    }
    for (size_t n = first; n < first + tap->neurons; n++)
        hist->mass[n] -= tap->samples;
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
