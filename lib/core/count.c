#include "count.h"

/* One neuron's range, ready to bin with. */
typedef struct axis {
    double mid, half;
    double bins;
} axis;

static axis axis_of(const vdna_hist *hist, size_t neuron)
{
    const double lo = hist->range[2 * neuron], hi = hist->range[2 * neuron + 1];
    const axis a = {(lo + hi) / 2, (hi - lo) / 2, hist->bins};
    return a;
}

/* The definition to the letter: half-open bins, the last closed. */
static uint32_t slot_of(const axis *a, uint32_t bins, float value)
{
    const double x = ((double)value - a->mid) / a->half;
    if (x < -1)
        return 0;
    if (x > 1)
        return bins + 1;
    /* x + 1 is not negative, so the conversion is the floor. */
    const uint32_t bin = (uint32_t)((x + 1) * a->bins / 2);
    return bin < bins ? bin + 1 : bins;
}

/* The count that a slot belongs to: samples beyond the range land in an edge bin. */
static uint32_t *count_of(const vdna_hist *hist, size_t neuron, uint32_t slot)
{
    const uint32_t last = hist->bins - 1, bin = slot == 0 ? 0 : slot - 1;
    return hist->counts + (size_t)(bin < last ? bin : last) * hist->neurons + neuron;
}

static uint32_t is_beyond(const vdna_hist *hist, uint32_t slot)
{
    return slot == 0 || slot > hist->bins;
}

/* How to walk over the values of a tap neuron by neuron. */
typedef struct walk {
    size_t neuron_step, sample_step;
} walk;

static walk walk_of(const vdna_activations *tap)
{
    const walk tokens = {1, tap->neurons}, map = {tap->samples, 1};
    return tap->layout == VDNA_LAYOUT_SAMPLES_NEURONS ? tokens : map;
}

/* Count one tap, whose first neuron is `first`. */
static void count_tap(vdna_hist *hist, size_t first, const vdna_activations *tap,
                      uint16_t *out_slots)
{
    const walk w = walk_of(tap);
    for (size_t n = 0; n < tap->neurons; n++) {
        const axis a = axis_of(hist, first + n);
        for (size_t s = 0; s < tap->samples; s++) {
            const size_t i = n * w.neuron_step + s * w.sample_step;
            const uint32_t slot = slot_of(&a, hist->bins, tap->values[i]);
            ++*count_of(hist, first + n, slot);
            hist->saturated[first + n] += is_beyond(hist, slot);
            if (out_slots)
                out_slots[i] = (uint16_t)slot;
        }
        hist->mass[first + n] += tap->samples;
    }
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
    const walk w = walk_of(tap);
    for (size_t n = 0; n < tap->neurons; n++) {
        for (size_t s = 0; s < tap->samples; s++) {
            const uint32_t slot = slots[n * w.neuron_step + s * w.sample_step];
            --*count_of(hist, first + n, slot);
            hist->saturated[first + n] -= is_beyond(hist, slot);
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
