#include "count.h"

#include "vectorised.h"

/* Neighbouring neurons are counted together, so that everything but the increments vectorises. */
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

/* The definition to the letter: half-open bins, the last one closed; values beyond the range land
 * in an edge bin. Branch-free: run time does not depend on the data.
 * @param x  position of the sample: -1 and 1 are the ends of the range */
/*@ requires VDNA_HIST_BINS_MIN <= bins <= VDNA_HIST_BINS_MAX;
    assigns \nothing;
    ensures \result < bins; */
static inline uint32_t bin_of(double x, uint32_t bins)
{
    const double place = (x + 1) * (bins / 2.0), last = bins - 1;
    const double not_above = place < last ? place : last;
    const double within = not_above > 0 ? not_above : 0;
    /*@ assert 0 <= within <= bins - 1; */
    return (uint32_t)(int32_t)within; /* the floor; vectors of x86-64 convert to int32_t only */
}

/*@ requires bin < bins && bins + SLOT_ABOVE <= UINT16_MAX;
    assigns \nothing;
    ensures \result == (is_beyond ? bins + (bin == 0 ? SLOT_BELOW : SLOT_ABOVE) : bin); */
static inline uint16_t slot_of(uint32_t bin, uint32_t is_beyond, uint32_t bins)
{
    const uint32_t beyond = bins + (bin == 0 ? SLOT_BELOW : SLOT_ABOVE);
    return (uint16_t)(is_beyond ? beyond : bin);
}

/*@ lemma cell: \forall integer bin, bins, n, neurons;
      0 <= bin < bins && 0 <= n < neurons ==> 0 <= bin * neurons + n < bins * neurons; */

/* Count a row: a sample of each of `count` neighbouring neurons. */
/*@ requires \valid_read(hist);
    requires VDNA_HIST_BINS_MIN <= hist->bins <= VDNA_HIST_BINS_MAX;
    requires \valid(hist->counts + (0 .. hist->bins * hist->neurons - 1));
    requires \valid(hist->saturated + (0 .. hist->neurons - 1));
    requires count <= AT_A_TIME && neuron + count <= hist->neurons;
    requires \valid_read(a) && \valid_read(values + (0 .. count - 1));
    requires out_slots == \null || (\valid(out_slots + (0 .. count - 1)) &&
      hist->bins + SLOT_ABOVE <= UINT16_MAX);
    requires \separated(hist, a, values + (0 .. count - 1),
      hist->counts + (0 .. hist->bins * hist->neurons - 1),
      hist->saturated + (0 .. hist->neurons - 1), out_slots + (0 .. count - 1));
    assigns hist->counts[0 .. hist->bins * hist->neurons - 1],
      hist->saturated[neuron .. neuron + count - 1], out_slots[0 .. count - 1]; */
static inline void count_row(vdna_hist *hist, const axes *a, size_t neuron, const float *values,
                             size_t count, uint16_t *out_slots)
{
    /* Copies, because the compiler cannot know that counting leaves the originals alone. */
    uint32_t *const counts = hist->counts + neuron, *const saturated = hist->saturated + neuron;
    const size_t neurons = hist->neurons;
    const uint32_t bins = hist->bins;
    uint32_t bin[AT_A_TIME], is_beyond[AT_A_TIME];
    /*@ loop invariant 0 <= i <= count;
        loop invariant \forall integer k; 0 <= k < i ==> bin[k] < bins;
        loop assigns i, bin[0 .. count - 1], is_beyond[0 .. count - 1];
        loop variant count - i; */
    for (size_t i = 0; i < count; i++) {
        const double x = (values[i] - a->mid[i]) / a->half[i];
        bin[i] = bin_of(x, bins);
        is_beyond[i] = (uint32_t)(x < -1) | (uint32_t)(x > 1);
    }
    /*@ loop invariant 0 <= i <= count;
        loop assigns i, saturated[0 .. count - 1];
        loop variant count - i; */
    for (size_t i = 0; i < count; i++)
        saturated[i] += is_beyond[i];
    /*@ loop invariant 0 <= i <= count;
        loop assigns i, hist->counts[0 .. bins * neurons - 1];
        loop variant count - i; */
    for (size_t i = 0; i < count; i++)
        counts[bin[i] * neurons + i]++;
    if (out_slots)
        /*@ loop invariant 0 <= i <= count;
            loop assigns i, out_slots[0 .. count - 1];
            loop variant count - i; */
        for (size_t i = 0; i < count; i++)
            out_slots[i] = slot_of(bin[i], is_beyond[i], bins);
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

/* Undo slot_of() and the counting of it; as branch-free. */
/*@ requires \valid_read(hist);
    requires VDNA_HIST_BINS_MIN <= hist->bins <= VDNA_HIST_BINS_MAX;
    requires \valid(hist->counts + (0 .. hist->bins * hist->neurons - 1));
    requires \valid(hist->saturated + (0 .. hist->neurons - 1));
    requires \separated(hist, hist->counts + (0 .. hist->bins * hist->neurons - 1),
      hist->saturated + (0 .. hist->neurons - 1));
    requires neuron < hist->neurons && slot <= hist->bins + SLOT_ABOVE;
    requires hist->bins + SLOT_ABOVE <= UINT16_MAX;
    assigns hist->counts[0 .. hist->bins * hist->neurons - 1], hist->saturated[neuron]; */
static void uncount_sample(vdna_hist *hist, size_t neuron, uint32_t slot)
{
    const uint32_t last = hist->bins - 1;
    const uint32_t not_above = slot < last ? slot : last;
    const uint32_t bin = slot == hist->bins + SLOT_BELOW ? 0 : not_above;
    hist->counts[(size_t)bin * hist->neurons + neuron]--;
    hist->saturated[neuron] -= slot > last;
}

static void uncount_tap(vdna_hist *hist, size_t first, const vdna_activations *tap,
                        const uint16_t *slots)
{
    for (size_t s = 0; s < tap->samples; s++)
        for (size_t n = first; n < first + tap->neurons; n++)
            uncount_sample(hist, n, *slots++);
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
