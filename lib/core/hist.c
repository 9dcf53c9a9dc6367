#include <string.h>

#include "count.h"
#include "growth.h"
#include "vectorised.h"

/* Bytes of vdna_hist_config in version 0.1. */
#define OLDEST_HIST_CONFIG sizeof(vdna_hist_config)

static const vdna_hist_config hist_defaults = {0, 0, VDNA_HIST_BINS_DEFAULT, NULL};

/* see vdna/hist.h */
void vdna_hist_config_init(vdna_hist_config *config)
{
    vdna_config_write(config, OLDEST_HIST_CONFIG, &hist_defaults, sizeof hist_defaults);
}

/* Read a caller's config. @return bytes of a histogram; 0 if a field breaks its rule */
static size_t read_hist_config(const vdna_hist_config *given, vdna_hist_config *out_config)
{
    *out_config = hist_defaults;
    if (!vdna_config_read(given, OLDEST_HIST_CONFIG, out_config, sizeof *out_config))
        return 0;
    const vdna_hist_config *c = out_config;
    if (c->neurons == 0 || c->bins < VDNA_HIST_BINS_MIN || c->bins > VDNA_HIST_BINS_MAX)
        return 0;
    /* Rows of counts, then one row each of mass and saturation. */
    const uint64_t size = (uint64_t)c->neurons * (c->bins + 2u) * sizeof(uint32_t);
    return size <= SIZE_MAX / 2 ? (size_t)size : 0;
}

/* see vdna/hist.h */
size_t vdna_hist_mem_size(const vdna_hist_config *config)
{
    vdna_hist_config known;
    return read_hist_config(config, &known);
}

/* see vdna/hist.h */
vdna_status vdna_hist_init(const vdna_hist_config *config, void *mem, size_t mem_size,
                           vdna_hist *out_hist)
{
    vdna_hist_config known;
    const size_t needed = read_hist_config(config, &known);
    if (needed == 0 || !mem || !out_hist || (uintptr_t)mem % sizeof(uint32_t) != 0)
        return VDNA_ERR_ARG;
    if (vdna_range_check(known.range, known.neurons) != VDNA_OK)
        return VDNA_ERR_ARG;
    if (mem_size < needed)
        return VDNA_ERR_NOMEM;

    const size_t neurons = known.neurons;
    out_hist->range = known.range;
    out_hist->counts = mem;
    out_hist->mass = out_hist->counts + neurons * known.bins;
    out_hist->saturated = out_hist->mass + neurons;
    out_hist->neurons = known.neurons;
    out_hist->bins = known.bins;
    vdna_hist_reset(out_hist);
    return VDNA_OK;
}

/* Whether a word is above `most`. No early exit, so that the loop vectorises: room is the rule. */
VDNA_VECTORISED static int any_above(const uint32_t *words, size_t count, uint32_t most)
{
    int above = 0;
    for (size_t i = 0; i < count; i++)
        above |= words[i] > most;
    return above;
}

/* see count.h; no count can exceed its neuron's mass, so capping the mass caps every count */
int vdna_fits_frame(const vdna_hist *hist, const vdna_activations *taps, size_t tap_count)
{
    size_t first = 0;
    for (size_t t = 0; t < tap_count; t++) {
        if (any_above(hist->mass + first, taps[t].neurons, UINT32_MAX - taps[t].samples))
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
    if (!vdna_fits_frame(hist, taps, tap_count))
        return VDNA_ERR_FULL;

    vdna_count_frame(hist, taps, tap_count, NULL);
    return VDNA_OK;
}

/* The contracts of these three are proved in test/hostile/proof. The prover handles sums more
 * easily as differences. */
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

/* Whether each word of `from` can be subtracted from that of `to`. */
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

/* Counts, mass and saturation lie in one block of rows: one loop serves all three. */
static size_t words_of(const vdna_hist *hist)
{
    return (size_t)hist->neurons * (hist->bins + 2u);
}

static vdna_hist_view view_of(const vdna_hist *hist)
{
    const vdna_hist_view view = {hist->range, hist->counts, hist->mass, hist->neurons, hist->bins};
    return view;
}

/* Ranges are compared by their bytes: histograms of one map share a range or have copies of it. */
static vdna_status check_same_shape(const vdna_hist_view *a, const vdna_hist_view *b)
{
    if (a->neurons != b->neurons || a->bins != b->bins)
        return VDNA_ERR_MISMATCH;
    if (a->range != b->range &&
        memcmp(a->range, b->range, 2 * sizeof(float) * (size_t)a->neurons) != 0)
        return VDNA_ERR_MISMATCH;
    return VDNA_OK;
}

static vdna_status check_addends(const vdna_hist *a, const vdna_hist *b)
{
    if (!a || !b)
        return VDNA_ERR_ARG;
    const vdna_hist_view view_a = view_of(a), view_b = view_of(b);
    return check_same_shape(&view_a, &view_b);
}

/* see vdna/hist.h */
vdna_status vdna_hist_merge(vdna_hist *hist, const vdna_hist *other)
{
    const vdna_status status = check_addends(hist, other);
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

/* Whether `hist` has as many samples within the range: counts alone cannot tell, because those
 * beyond it are counted in the edge bins as well. */
static int holds_unsaturated(const vdna_hist *hist, const vdna_hist *other)
{
    for (size_t n = 0; n < hist->neurons; n++)
        if (other->mass[n] - other->saturated[n] > hist->mass[n] - hist->saturated[n])
            return 0;
    return 1;
}

/* see vdna/hist.h */
vdna_status vdna_hist_subtract(vdna_hist *hist, const vdna_hist *other)
{
    const vdna_status status = check_addends(hist, other);
    if (status != VDNA_OK)
        return status;
    const size_t words = words_of(hist);
    if (other->frames > hist->frames)
        return VDNA_ERR_UNDERFLOW;
    if (!holds_words(hist->counts, other->counts, words) || !holds_unsaturated(hist, other))
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
    *out_view = view_of(hist);
}

static int is_view(const vdna_hist_view *view)
{
    return view && view->range && view->counts && view->mass && view->neurons > 0 &&
           view->bins >= VDNA_HIST_BINS_MIN && view->bins <= VDNA_HIST_BINS_MAX;
}

/* see vdna/hist.h */
vdna_status vdna_hist_view_check_pair(const vdna_hist_view *p, const vdna_hist_view *q)
{
    if (!is_view(p) || !is_view(q))
        return VDNA_ERR_ARG;
    const vdna_status status = check_same_shape(p, q);
    if (status != VDNA_OK)
        return status;
    for (size_t n = 0; n < p->neurons; n++)
        if (p->mass[n] == 0 || q->mass[n] == 0)
            return VDNA_ERR_EMPTY;
    return VDNA_OK;
}

/* see vdna/hist.h */
vdna_status vdna_hist_view_mean(const vdna_hist_view *view, uint32_t neuron, double *out_bin)
{
    if (!is_view(view) || neuron >= view->neurons || !out_bin)
        return VDNA_ERR_ARG;
    if (view->mass[neuron] == 0)
        return VDNA_ERR_EMPTY;

    uint64_t sum = 0; /* below 2^48: the mass times the bins */
    for (uint32_t b = 0; b < view->bins; b++)
        sum += (uint64_t)b * view->counts[(size_t)b * view->neurons + neuron];
    *out_bin = (double)sum / view->mass[neuron];
    return VDNA_OK;
}
