#include <string.h>
#include <vdna/hist.h>

/* see vdna/hist.h */
void vdna_hist_config_init(vdna_hist_config *config)
{
    if (!config)
        return;
    memset(config, 0, sizeof *config);
    config->struct_size = sizeof *config;
    config->bins = VDNA_HIST_BINS_DEFAULT;
}

/* see vdna/hist.h */
size_t vdna_hist_mem_size(const vdna_hist_config *config)
{
    if (!config || config->struct_size != sizeof *config || config->neurons == 0 ||
        config->bins < VDNA_HIST_BINS_MIN || config->bins > VDNA_HIST_BINS_MAX)
        return 0;
    /* Rows of counts, then one row each of mass and saturation. */
    const uint64_t size = (uint64_t)config->neurons * (config->bins + 2u) * sizeof(uint32_t);
    return size <= SIZE_MAX / 2 ? (size_t)size : 0;
}

/* see vdna/hist.h */
vdna_status vdna_hist_init(const vdna_hist_config *config, void *mem, size_t mem_size,
                           vdna_hist *out_hist)
{
    const size_t needed = vdna_hist_mem_size(config);
    if (needed == 0 || !mem || !out_hist || (uintptr_t)mem % sizeof(uint32_t) != 0)
        return VDNA_ERR_ARG;
    if (vdna_range_check(config->range, config->neurons) != VDNA_OK)
        return VDNA_ERR_ARG;
    if (mem_size < needed)
        return VDNA_ERR_NOMEM;

    const size_t neurons = config->neurons;
    out_hist->range = config->range;
    out_hist->counts = mem;
    out_hist->mass = out_hist->counts + neurons * config->bins;
    out_hist->saturated = out_hist->mass + neurons;
    out_hist->neurons = config->neurons;
    out_hist->bins = config->bins;
    vdna_hist_reset(out_hist);
    return VDNA_OK;
}

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

/* Count one sample of `neuron`: the definition to the letter, half-open bins, the last closed. */
static void count_sample(vdna_hist *hist, const axis *a, size_t neuron, float value)
{
    double x = ((double)value - a->mid) / a->half;
    if (x < -1 || x > 1) {
        hist->saturated[neuron]++;
        x = x < 0 ? -1 : 1;
    }
    /* x + 1 is not negative, so the conversion is the floor. */
    uint32_t bin = (uint32_t)((x + 1) * a->bins / 2);
    if (bin > hist->bins - 1)
        bin = hist->bins - 1;
    hist->counts[(size_t)bin * hist->neurons + neuron]++;
}

/* Count one tap, whose first neuron is `first`. */
static void count_tap(vdna_hist *hist, size_t first, const vdna_activations *tap)
{
    const int tokens = tap->layout == VDNA_LAYOUT_SAMPLES_NEURONS;
    const size_t neuron_step = tokens ? 1 : tap->samples;
    const size_t sample_step = tokens ? tap->neurons : 1;

    for (size_t n = 0; n < tap->neurons; n++) {
        const axis a = axis_of(hist, first + n);
        for (size_t s = 0; s < tap->samples; s++)
            count_sample(hist, &a, first + n, tap->values[n * neuron_step + s * sample_step]);
        hist->mass[first + n] += tap->samples;
    }
}

/* No count can exceed its neuron's mass, so capping the mass keeps every count from wrapping. */
static int fits(const vdna_hist *hist, const vdna_activations *taps, size_t tap_count)
{
    size_t first = 0;
    for (size_t t = 0; t < tap_count; t++) {
        for (size_t n = 0; n < taps[t].neurons; n++)
            if (taps[t].samples > UINT32_MAX - hist->mass[first + n])
                return 0;
        first += taps[t].neurons;
    }
    return hist->frames < UINT32_MAX;
}

/* see vdna/hist.h */
vdna_status vdna_hist_add(vdna_hist *hist, const vdna_activations *taps, size_t tap_count)
{
    if (!hist)
        return VDNA_ERR_ARG;
    const vdna_status status = vdna_activations_check(taps, tap_count, hist->neurons);
    if (status != VDNA_OK)
        return status;
    if (!fits(hist, taps, tap_count))
        return VDNA_ERR_FULL;

    size_t first = 0;
    for (size_t t = 0; t < tap_count; t++) {
        count_tap(hist, first, &taps[t]);
        first += taps[t].neurons;
    }
    hist->frames++;
    return VDNA_OK;
}

/* The contracts of these three are proved in test/proof; Z3 finds sums easier as differences. */
/*@ requires \valid(to + (0 .. words - 1)) && \valid_read(from + (0 .. words - 1));
    requires \separated(to + (0 .. words - 1), from + (0 .. words - 1));
    requires \forall integer i; 0 <= i < words ==> to[i] <= UINT32_MAX - from[i];
    assigns to[0 .. words - 1];
    ensures \forall integer i; 0 <= i < words ==> to[i] == \old(to[i]) + from[i]; */
static void add_words(uint32_t *to, const uint32_t *from, size_t words)
{
    /*@ loop invariant 0 <= i <= words;
        loop invariant \forall integer k; 0 <= k < words ==>
          to[k] == \at(to[k], Pre) - (k < i ? -from[k] : 0);
        loop assigns i, to[0 .. words - 1];
        loop variant words - i; */
    for (size_t i = 0; i < words; i++)
        to[i] += from[i];
}

/* Whether each word of `to` can be diminished by that of `from`. */
/*@ requires \valid_read(to + (0 .. words - 1)) && \valid_read(from + (0 .. words - 1));
    assigns \nothing;
    ensures \result != 0 ==> \forall integer i; 0 <= i < words ==> from[i] <= to[i]; */
static int holds_words(const uint32_t *to, const uint32_t *from, size_t words)
{
    /*@ loop invariant 0 <= i <= words;
        loop invariant \forall integer k; 0 <= k < i ==> from[k] <= to[k];
        loop assigns i;
        loop variant words - i; */
    for (size_t i = 0; i < words; i++)
        if (from[i] > to[i])
            return 0;
    return 1;
}

/*@ requires \valid(to + (0 .. words - 1)) && \valid_read(from + (0 .. words - 1));
    requires \separated(to + (0 .. words - 1), from + (0 .. words - 1));
    requires \forall integer i; 0 <= i < words ==> from[i] <= to[i];
    assigns to[0 .. words - 1];
    ensures \forall integer i; 0 <= i < words ==> to[i] == \old(to[i]) - from[i]; */
static void subtract_words(uint32_t *to, const uint32_t *from, size_t words)
{
    /*@ loop invariant 0 <= i <= words;
        loop invariant \forall integer k; 0 <= k < words ==>
          to[k] == \at(to[k], Pre) - (k < i ? from[k] : 0);
        loop assigns i, to[0 .. words - 1];
        loop variant words - i; */
    for (size_t i = 0; i < words; i++)
        to[i] -= from[i];
}

/* Counts, mass and saturation lie in one block of rows: what is true of one is done to all. */
static size_t words_of(const vdna_hist *hist)
{
    return (size_t)hist->neurons * (hist->bins + 2u);
}

static vdna_status check_same_shape(const vdna_hist *a, const vdna_hist *b)
{
    if (!a || !b)
        return VDNA_ERR_ARG;
    if (a->neurons != b->neurons || a->bins != b->bins ||
        memcmp(a->range, b->range, 2 * sizeof(float) * (size_t)a->neurons) != 0)
        return VDNA_ERR_MISMATCH;
    return VDNA_OK;
}

/* see vdna/hist.h */
vdna_status vdna_hist_merge(vdna_hist *hist, const vdna_hist *other)
{
    const vdna_status status = check_same_shape(hist, other);
    if (status != VDNA_OK)
        return status;
    if (other->frames > UINT32_MAX - hist->frames)
        return VDNA_ERR_FULL;
    for (size_t n = 0; n < hist->neurons; n++)
        if (other->mass[n] > UINT32_MAX - hist->mass[n])
            return VDNA_ERR_FULL;

    add_words(hist->counts, other->counts, words_of(hist));
    hist->frames += other->frames;
    return VDNA_OK;
}

/* see vdna/hist.h */
vdna_status vdna_hist_subtract(vdna_hist *hist, const vdna_hist *other)
{
    const vdna_status status = check_same_shape(hist, other);
    if (status != VDNA_OK)
        return status;
    const size_t words = words_of(hist);
    if (other->frames > hist->frames)
        return VDNA_ERR_UNDERFLOW;
    if (!holds_words(hist->counts, other->counts, words))
        return VDNA_ERR_UNDERFLOW;

    subtract_words(hist->counts, other->counts, words);
    hist->frames -= other->frames;
    return VDNA_OK;
}

/* see vdna/hist.h */
void vdna_hist_reset(vdna_hist *hist)
{
    if (!hist)
        return;
    memset(hist->counts, 0, words_of(hist) * sizeof *hist->counts);
    hist->frames = 0;
}

/* see vdna/hist.h */
void vdna_hist_view_of(const vdna_hist *hist, vdna_hist_view *out_view)
{
    if (!hist || !out_view)
        return;
    out_view->range = hist->range;
    out_view->counts = hist->counts;
    out_view->mass = hist->mass;
    out_view->neurons = hist->neurons;
    out_view->bins = hist->bins;
}
