#include "place_filter.h"

#include "elementary.h"
#include "vectorised.h"

enum { BLOCK_FRAMES = VDNA_MOTION_BLOCK, REACH = VDNA_MOTION_REACH, SOURCES = VDNA_MOTION_SOURCES };

/* Independent partial sums, always added up in the same order, so that loops vectorise and give the
 * same bits, vectorised or not. */
enum { SUMS = 8, BLOCK_SUMS = 32 };

static double total_of(const double *sums)
{
    double total = 0;
    for (size_t l = 0; l < SUMS; l++)
        total += sums[l];
    return total;
}

/* ---- Contrast of the distances ---- */

VDNA_VECTORISED static double mean_of(const float *distances, size_t count)
{
    double sums[SUMS] = {0};
    size_t i = 0;
    for (; i + SUMS <= count; i += SUMS)
        for (size_t l = 0; l < SUMS; l++)
            sums[l] += distances[i + l];
    for (size_t l = 0; i + l < count; l++)
        sums[l] += distances[i + l];
    return total_of(sums) / (double)count;
}

VDNA_VECTORISED static double variance_of(const float *distances, size_t count, double mean)
{
    double sums[SUMS] = {0};
    size_t i = 0;
    for (; i + SUMS <= count; i += SUMS)
        for (size_t l = 0; l < SUMS; l++)
            sums[l] += (distances[i + l] - mean) * (distances[i + l] - mean);
    for (size_t l = 0; i + l < count; l++)
        sums[l] += (distances[i + l] - mean) * (distances[i + l] - mean);
    return total_of(sums) / (double)count;
}

VDNA_VECTORISED static float least_of(const float *distances, size_t count)
{
    enum { LEASTS = 16 };
    float least[LEASTS];
    for (size_t l = 0; l < LEASTS; l++)
        least[l] = distances[0];
    size_t i = 0;
    for (; i + LEASTS <= count; i += LEASTS)
        for (size_t l = 0; l < LEASTS; l++)
            least[l] = distances[i + l] < least[l] ? distances[i + l] : least[l];
    for (; i < count; i++)
        least[0] = distances[i] < least[0] ? distances[i] : least[0];
    for (size_t l = 1; l < LEASTS; l++)
        least[0] = least[l] < least[0] ? least[l] : least[0];
    return least[0];
}

/* The lowest index of a value that occurs. Always looks at all, as all steps do. */
VDNA_VECTORISED static uint32_t index_of(const float *distances, uint32_t count, float value)
{
    uint32_t lowest = count;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t index = distances[i] == value ? i : count;
        lowest = index < lowest ? index : lowest;
    }
    return lowest;
}

/* see place_filter.h */
vdna_row_contrast vdna_row_contrast_of(const float *distances, uint32_t count)
{
    vdna_row_contrast contrast;
    contrast.mean = mean_of(distances, count);
    contrast.deviation = vdna_sqrt(variance_of(distances, count, contrast.mean));
    contrast.least = least_of(distances, count);
    contrast.nearest = index_of(distances, count, contrast.least);
    return contrast;
}

/* ---- Evidence ---- */

/* Likelihoods relative to that of the nearest frame.
 * @return their sum */
VDNA_VECTORISED static double likelihoods(const float *restrict distances, size_t count,
                                          double least, double per_distance, double *restrict out)
{
    for (size_t i = 0; i < count; i++)
        out[i] = vdna_exp((least - distances[i]) * per_distance);
    double sums[SUMS] = {0};
    size_t i = 0;
    for (; i + SUMS <= count; i += SUMS)
        for (size_t l = 0; l < SUMS; l++)
            sums[l] += out[i + l];
    for (size_t l = 0; i + l < count; l++)
        sums[l] += out[i + l];
    return total_of(sums);
}

/* ---- Motion ---- */

/* Sources of the `count` frames from `begin`, of each gear; none beyond the ends of the map.
 * @param out  [gears][SOURCES], of which the first `count` are written */
VDNA_VECTORISED static void sources_of(const vdna_place_filter *filter, size_t begin, size_t count,
                                       double *restrict out)
{
    const size_t frames = filter->frames, gears = filter->gear_count;
    const size_t inside = begin >= frames ? 0 : frames - begin < count ? frames - begin : count;
    const double *posterior = filter->posterior + begin;
    const double stay = filter->scale * (1 - filter->gear_change);
    const double change = filter->scale * filter->gear_change / (double)gears;
    double all[BLOCK_FRAMES] = {0};
    for (size_t g = 0; g < gears; g++)
        for (size_t i = 0; i < inside; i++)
            all[i] += posterior[g * frames + i];
    for (size_t g = 0; g < gears; g++) {
        for (size_t i = 0; i < inside; i++)
            out[g * SOURCES + i] = stay * posterior[g * frames + i] + change * all[i];
        for (size_t i = inside; i < count; i++)
            out[g * SOURCES + i] = 0;
    }
}

/* What the gears would carry beyond one end of the map, and so leave there.
 * @param out_kept  [gears] */
static void kept_at_end(const vdna_place_filter *filter, int is_upper, double *out_kept)
{
    const size_t near = filter->frames < REACH ? filter->frames : REACH;
    sources_of(filter, is_upper ? filter->frames - near : 0, near, filter->sources);
    for (size_t g = 0; g < filter->gear_count; g++) {
        const vdna_gear *gear = &filter->gears[g];
        out_kept[g] = 0;
        for (int32_t i = 0; i < (int32_t)near; i++)
            for (int32_t k = 0; k < VDNA_GEAR_SHARES; k++) {
                const int32_t to = i + gear->first + k;
                const int is_beyond = is_upper ? to >= (int32_t)near : to < 0;
                out_kept[g] +=
                    is_beyond ? gear->share[k] * filter->sources[g * SOURCES + (size_t)i] : 0;
            }
    }
}

/* What arrives at a frame, if `source` is that of the frame `first` before it. */
static inline double arrival(const double *share, const double *source)
{
    return share[0] * source[0] + share[1] * source[-1] + share[2] * source[-2] +
           share[3] * source[-3] + share[4] * source[-4] + share[5] * source[-5];
}

/* Move the posterior of the `count` frames from `begin`.
 * @param sources  of the frames from begin - REACH to begin + count + REACH */
VDNA_VECTORISED static void move_block(const vdna_place_filter *filter, size_t begin, size_t count)
{
    const double go_on = 1 - filter->jump;
    const double jump = filter->jump / ((double)filter->gear_count * filter->frames);
    for (size_t g = 0; g < filter->gear_count; g++) {
        const vdna_gear *gear = &filter->gears[g];
        const double *source = filter->sources + g * SOURCES + (REACH - gear->first);
        double *restrict posterior = filter->posterior + g * filter->frames + begin;
        for (size_t i = 0; i < count; i++)
            posterior[i] = go_on * arrival(gear->share, source + i) + jump;
    }
}

/* Weigh the posterior of the `count` frames from `begin`, and turn their likelihoods, in `places`,
 * into their places.
 * @param factor  of the likelihoods, which makes the mean weight 1 */
VDNA_VECTORISED static void weigh_block(const vdna_place_filter *filter, size_t begin, size_t count,
                                        double factor)
{
    double weights[BLOCK_FRAMES];
    double *restrict places = filter->places + begin;
    for (size_t i = 0; i < count; i++) {
        weights[i] = factor * places[i] + filter->clutter;
        places[i] = 0;
    }
    for (size_t g = 0; g < filter->gear_count; g++) {
        double *restrict posterior = filter->posterior + g * filter->frames + begin;
        for (size_t i = 0; i < count; i++) {
            posterior[i] *= weights[i];
            places[i] += posterior[i];
        }
    }
}

/* Add what the gears leave at the ends of the map to the posterior of the `count` frames from
 * `begin`, if an end is among them. */
static void add_kept(const vdna_place_filter *filter, size_t begin, size_t count,
                     double kept[2][VDNA_GEARS_MAX])
{
    for (size_t g = 0; g < filter->gear_count; g++) {
        double *posterior = filter->posterior + g * filter->frames;
        if (begin == 0)
            posterior[0] += (1 - filter->jump) * kept[0][g];
        if (begin + count == filter->frames)
            posterior[filter->frames - 1] += (1 - filter->jump) * kept[1][g];
    }
}

/* Make the sources of the block at `begin` and of its surroundings, of which all but the last
 * BLOCK_FRAMES have been made for the block before. */
static void advance_sources(const vdna_place_filter *filter, size_t begin)
{
    for (size_t g = 0; g < filter->gear_count; g++)
        memcpy(filter->sources + g * SOURCES, filter->sources + g * SOURCES + BLOCK_FRAMES,
               2 * REACH * sizeof *filter->sources);
    sources_of(filter, begin + REACH, BLOCK_FRAMES, filter->sources + 2 * (size_t)REACH);
}

/* Move the posterior, unless this is the first step, and weigh it, block by block. In place:
 * sources are kept apart before they are overwritten. */
static void update(const vdna_place_filter *filter, double factor)
{
    double kept[2][VDNA_GEARS_MAX];
    if (filter->steps > 0) {
        kept_at_end(filter, 0, kept[0]);
        kept_at_end(filter, 1, kept[1]);
        /* As if a block of nothing had gone before the first. */
        memset(filter->sources, 0, (size_t)filter->gear_count * SOURCES * sizeof *filter->sources);
        sources_of(filter, 0, REACH, filter->sources + BLOCK_FRAMES + REACH);
    }
    for (size_t begin = 0; begin < filter->frames; begin += BLOCK_FRAMES) {
        const size_t left = filter->frames - begin;
        const size_t count = left < BLOCK_FRAMES ? left : BLOCK_FRAMES;
        if (filter->steps > 0) {
            advance_sources(filter, begin);
            move_block(filter, begin, count);
            add_kept(filter, begin, count, kept);
        }
        weigh_block(filter, begin, count, factor);
    }
}

/* see place_filter.h */
void vdna_place_filter_reset(vdna_place_filter *filter)
{
    const size_t states = (size_t)filter->gear_count * filter->frames;
    for (size_t i = 0; i < states; i++)
        filter->posterior[i] = 1;
    for (size_t i = 0; i < filter->frames; i++)
        filter->places[i] = filter->gear_count;
    filter->scale = 1 / (double)states;
    filter->evidence = 0;
    filter->jumps = 0;
    filter->steps = 0;
}

/* ---- Answer ---- */

static size_t frame_at(const vdna_place_filter *filter, size_t order)
{
    return filter->windows ? filter->windows[order].frame : order;
}

/* Running sums of the places, in their order. A block begins with the sum of those before it, added
 * up apart, so a processor can work on several blocks at once.
 * @return the sum of all */
static double add_up(const vdna_place_filter *filter)
{
    double before = 0;
    filter->sums[0] = 0;
    for (size_t begin = 0; begin < filter->frames; begin += BLOCK_SUMS) {
        const size_t left = filter->frames - begin, count = left < BLOCK_SUMS ? left : BLOCK_SUMS;
        double block[BLOCK_SUMS] = {0};
        for (size_t i = 0; i < count; i++)
            block[i] = filter->places[frame_at(filter, begin + i)];
        double sum = before;
        for (size_t i = 0; i < count; i++) {
            sum += block[i];
            filter->sums[begin + i + 1] = sum;
        }
        double partial[SUMS] = {0};
        for (size_t i = 0; i < BLOCK_SUMS; i += SUMS)
            for (size_t l = 0; l < SUMS; l++)
                partial[l] += block[i + l];
        before += total_of(partial);
    }
    return before;
}

static vdna_place_window window_of(const vdna_place_filter *filter, uint32_t i)
{
    if (filter->windows)
        return filter->windows[i];
    const uint32_t after = filter->frames - 1 - i, tolerance = filter->tolerance;
    const vdna_place_window window = {i, i > tolerance ? i - tolerance : 0,
                                      after > tolerance ? i + tolerance + 1 : filter->frames};
    return window;
}

/* The window of most mass, the first of equals. */
static vdna_place_window heaviest(const vdna_place_filter *filter, double *out_mass)
{
    uint32_t best = 0;
    double most = -1;
    for (uint32_t i = 0; i < filter->frames; i++) {
        const vdna_place_window window = window_of(filter, i);
        const double mass = filter->sums[window.past] - filter->sums[window.first];
        best = mass > most ? i : best;
        most = mass > most ? mass : most;
    }
    *out_mass = most;
    return window_of(filter, best);
}

static uint32_t likeliest(const vdna_place_filter *filter, const vdna_place_window *window)
{
    size_t best = frame_at(filter, window->first);
    for (size_t i = window->first; i < window->past; i++)
        if (filter->places[frame_at(filter, i)] > filter->places[best])
            best = frame_at(filter, i);
    return (uint32_t)best;
}

static float least_distance_in(const vdna_place_filter *filter, const vdna_place_window *window,
                               const float *distances)
{
    float least = distances[frame_at(filter, window->first)];
    for (size_t i = window->first; i < window->past; i++)
        if (distances[frame_at(filter, i)] < least)
            least = distances[frame_at(filter, i)];
    return least;
}

static double confidence_of(const vdna_place_filter *filter, double mass, double distance)
{
    double logit = vdna_log(mass / (1 - mass));
    logit = logit < -8 ? -8 : logit > 8 ? 8 : logit;
    const double *c = filter->confidence;
    return 1 / (1 + vdna_exp(-(c[0] + c[1] * logit + c[2] * filter->evidence + c[3] * distance)));
}

/* Whether a gear carries anything from one frame to the other. */
static int is_in_reach(const vdna_place_filter *filter, uint32_t from, size_t to)
{
    for (size_t g = 0; g < filter->gear_count; g++) {
        const vdna_gear *gear = &filter->gears[g];
        const int64_t share = (int64_t)to - from - gear->first;
        if (share >= 0 && share < VDNA_GEAR_SHARES && gear->share[share] > 0)
            return 1;
    }
    return 0;
}

/* Whether the robot would have to be carried from `before` to get into the window. */
static int is_jump(const vdna_place_filter *filter, uint32_t before,
                   const vdna_place_window *window)
{
    for (size_t i = window->first; i < window->past; i++)
        if (is_in_reach(filter, before, frame_at(filter, i)))
            return 0;
    return 1;
}

/* see place_filter.h */
void vdna_place_filter_step(vdna_place_filter *filter, const float *distances,
                            const vdna_row_contrast *contrast, vdna_localise_answer *answer)
{
    const double sum =
        likelihoods(distances, filter->frames, contrast->least,
                    filter->sharpness / (contrast->deviation + 1e-9), filter->places);
    update(filter, (1 - filter->clutter) * filter->frames / sum);

    const double total = add_up(filter);
    filter->scale = 1 / total;
    if (filter->steps > 0)
        filter->evidence += filter->evidence_share * (vdna_log(total) - filter->evidence);

    double mass;
    const vdna_place_window window = heaviest(filter, &mass);
    mass *= filter->scale;
    mass = mass > 1 - 1e-9 ? 1 - 1e-9 : mass;
    /* Until then it looks for its place. */
    const int is_led_in = filter->steps == VDNA_LOCALISE_LEAD_FRAMES;
    filter->jumps <<= 1;
    if (is_led_in && is_jump(filter, answer->frame, &window))
        filter->jumps |= 1;
    filter->steps += !is_led_in;
    answer->frame = likeliest(filter, &window);
    answer->mass = mass;
    answer->confidence = confidence_of(filter, mass, least_distance_in(filter, &window, distances));
}
