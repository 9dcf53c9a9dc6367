#include "elementary.h"
#include "growth.h"
#include "localise_map.h"
#include "place_filter.h"
#include "vectorised.h"

/* Bytes of vdna_localise_config in the version that brought it. */
#define OLDEST_LOCALISE_CONFIG sizeof(vdna_localise_config)

static const vdna_localise_config localise_defaults = {
    .mean_frames = 3,
    .mean_frames_max = 1000,
    .gate = 0.15,
    .sharpness = 2,
    .clutter = 0.1,
    .jump = 0.01,
    .gear_change = 0.05,
    .evidence_share = 0.15,
    .confidence = {3.6, 0.53, 1.1, -12},
};

static const vdna_gear default_gears[] = {
    {-1, 0, {.02, .2, .4, .25, .1, .03}},
    {2, 0, {.15, .3, .3, .15, .1}},
    {-4, 0, {.03, .1, .25, .4, .22}},
};

/* At the beginning of the caller's block. */
struct vdna_localise {
    vdna_place_filter filter;
    const vdna_localise_map *map;
    double *mean;       /* [dim], of the live frames */
    float *last;        /* [dim], the last frame that counted, if any */
    float *distances;   /* [frames] */
    int16_t *direction; /* [stride], of the present frame from the mean */
    vdna_localise_answer answer;
    double gate_sq; /* squared distance within which the robot stands */
    uint32_t mean_frames, mean_frames_max;
    uint32_t counted; /* frames in the mean */
    uint32_t has_last;
};

/* see vdna/localise.h */
void vdna_localise_config_init(vdna_localise_config *config)
{
    vdna_config_write(config, OLDEST_LOCALISE_CONFIG, &localise_defaults, sizeof localise_defaults);
}

/* ---- Checking a config ---- */

/* False for NaN. */
static int is_within(double value, double least, double most)
{
    return value >= least && value <= most;
}

static int is_gear(const vdna_gear *gear)
{
    double sum = 0;
    for (size_t k = 0; k < VDNA_GEAR_SHARES; k++) {
        if (!is_within(gear->share[k], 0, 2))
            return 0;
        sum += gear->share[k];
    }
    return gear->first >= VDNA_GEAR_FIRST_MIN && gear->first <= VDNA_GEAR_FIRST_MAX &&
           is_within(sum, 1 - 1e-6, 1 + 1e-6);
}

static int are_gears(const vdna_gear *gears, uint32_t count)
{
    if (count == 0 || count > VDNA_GEARS_MAX)
        return 0;
    for (uint32_t g = 0; g < count; g++)
        if (!is_gear(&gears[g]))
            return 0;
    return 1;
}

static int is_localise_config(const vdna_localise_config *config)
{
    for (size_t c = 0; c < 4; c++)
        if (!is_within(config->confidence[c], -100, 100))
            return 0;
    return config->map && config->mean_frames_max > 0 &&
           config->mean_frames <= config->mean_frames_max && is_within(config->gate, 0, 1e18) &&
           is_within(config->sharpness, 0, 100) && config->clutter > 0 && config->clutter <= 1 &&
           is_within(config->jump, 0, 1) && is_within(config->gear_change, 0, 1) &&
           is_within(config->evidence_share, 0, 1) &&
           (config->gears ? are_gears(config->gears, config->gear_count) : config->gear_count == 0);
}

/* ---- Making one ---- */

/* Elements of the caller's block behind the struct, widest first. */
typedef struct localise_layout {
    size_t posterior, places, sums, sources, mean; /* doubles */
    size_t windows;
    size_t last, distances;      /* floats */
    size_t direction;            /* int16_t */
    size_t total;                /* bytes, with the struct; 0 if the config is invalid */
    vdna_localise_config config; /* complete */
} localise_layout;

/* Bytes of a map frame, at most. */
enum { FRAME_BYTES_MAX = (VDNA_GEARS_MAX + 2) * 8 + 4 + 12 };

static localise_layout layout_of_localise(const vdna_localise_config *given)
{
    localise_layout l;
    memset(&l, 0, sizeof l);
    l.config = localise_defaults;
    if (!vdna_config_read(given, OLDEST_LOCALISE_CONFIG, &l.config, sizeof l.config) ||
        !is_localise_config(&l.config))
        return l;
    if (!l.config.gears) {
        l.config.gears = default_gears;
        l.config.gear_count = sizeof default_gears / sizeof *default_gears;
    }
    const size_t frames = l.config.map->frames, dim = l.config.map->dim;
    /* All that does not grow with the frames is far below half of any memory. */
    if (frames > SIZE_MAX / 2 / FRAME_BYTES_MAX)
        return l;
    l.posterior = l.config.gear_count * frames;
    l.places = frames;
    l.sums = frames + 1;
    l.sources = (size_t)l.config.gear_count * VDNA_MOTION_SOURCES;
    l.mean = l.last = dim;
    l.direction = l.config.map->stride;
    l.windows = l.config.place ? frames : 0;
    l.distances = frames;
    l.total = sizeof(vdna_localise) +
              sizeof(double) * (l.posterior + l.places + l.sums + l.sources + l.mean) +
              sizeof(vdna_place_window) * l.windows + sizeof(float) * (l.last + l.distances) +
              sizeof(int16_t) * l.direction;
    return l;
}

/* see vdna/localise.h */
size_t vdna_localise_mem_size(const vdna_localise_config *config)
{
    return layout_of_localise(config).total;
}

/* Everything of a filter but what vdna_place_filter_reset() sets. */
static void set_filter(vdna_place_filter *filter, const localise_layout *l)
{
    const vdna_localise_config *config = &l->config;
    filter->sharpness = config->sharpness;
    filter->clutter = config->clutter;
    filter->jump = config->jump;
    filter->gear_change = config->gear_change;
    filter->evidence_share = config->evidence_share;
    memcpy(filter->confidence, config->confidence, sizeof filter->confidence);
    memcpy(filter->gears, config->gears, config->gear_count * sizeof *config->gears);
    filter->gear_count = config->gear_count;
    filter->frames = config->map->frames;
    filter->tolerance = config->tolerance;
    if (config->place)
        vdna_place_windows(config->place, filter->frames, filter->tolerance, filter->windows);
}

static void set_pointers(vdna_localise *localise, const localise_layout *l)
{
    vdna_place_filter *filter = &localise->filter;
    filter->posterior = (double *)(void *)(localise + 1);
    filter->places = filter->posterior + l->posterior;
    filter->sums = filter->places + l->places;
    filter->sources = filter->sums + l->sums;
    localise->mean = filter->sources + l->sources;
    vdna_place_window *const windows = (vdna_place_window *)(void *)(localise->mean + l->mean);
    filter->windows = l->config.place ? windows : NULL;
    localise->last = (float *)(void *)(windows + l->windows);
    localise->distances = localise->last + l->last;
    localise->direction = (int16_t *)(void *)(localise->distances + l->distances);
}

/* see vdna/localise.h */
vdna_status vdna_localise_init(const vdna_localise_config *config, void *mem, size_t mem_size,
                               vdna_localise **out_localise)
{
    const localise_layout l = layout_of_localise(config);
    if (l.total == 0 || !mem || !out_localise || (uintptr_t)mem % sizeof(int64_t) != 0)
        return VDNA_ERR_ARG;
    if (mem_size < l.total)
        return VDNA_ERR_NOMEM;
    vdna_localise *localise = mem;
    memset(localise, 0, sizeof *localise);
    localise->map = l.config.map;
    set_pointers(localise, &l);
    set_filter(&localise->filter, &l);
    const double gate = l.config.gate * l.config.map->step;
    localise->gate_sq = gate * gate;
    localise->mean_frames = l.config.mean_frames;
    localise->mean_frames_max = l.config.mean_frames_max;
    vdna_localise_reset(localise);
    *out_localise = localise;
    return VDNA_OK;
}

/* see vdna/localise.h */
void vdna_localise_reset(vdna_localise *localise)
{
    if (!localise)
        return;
    vdna_place_filter_reset(&localise->filter);
    /* A mean that is worth nothing begins as 0, so that the first frame becomes it to the last bit.
     */
    const size_t bytes = localise->map->dim * sizeof *localise->mean;
    if (localise->mean_frames > 0)
        memcpy(localise->mean, localise->map->mean, bytes);
    else
        memset(localise->mean, 0, bytes);
    memset(localise->distances, 0, localise->map->frames * sizeof *localise->distances);
    memset(&localise->answer, 0, sizeof localise->answer);
    localise->counted = localise->mean_frames;
    localise->has_last = 0;
}

/* ---- The live mean ---- */

/* Whether the robot has moved away from the last frame that counted. */
static int is_moving(const vdna_localise *localise, const float *embedding)
{
    double sum = 0;
    for (size_t i = 0; i < localise->map->dim; i++) {
        const double difference = (double)embedding[i] - localise->last[i];
        sum += difference * difference;
    }
    return !localise->has_last || sum > localise->gate_sq;
}

/* Count a frame if the robot has moved.
 * @return whether it has */
static int take_into_mean(vdna_localise *localise, const float *embedding)
{
    if (!is_moving(localise, embedding))
        return 0;
    const size_t dim = localise->map->dim;
    if (localise->counted < localise->mean_frames_max)
        localise->counted++;
    if (localise->map->centred)
        for (size_t i = 0; i < dim; i++)
            localise->mean[i] += (embedding[i] - localise->mean[i]) / localise->counted;
    memcpy(localise->last, embedding, dim * sizeof *embedding);
    localise->has_last = 1;
    return 1;
}

/* ---- Distances ---- */

/* The lengths of rounded directions differ from 1, so their product may leave -1..1. */
static double within_0_and_2(double distance)
{
    const double least = distance > 0 ? distance : 0;
    return least < 2 ? least : 2;
}

/* Distances of all rows. Sums of integers do not depend on their order: they vectorise, and give
 * the same bits on every machine. */
VDNA_VECTORISED static void row_distances(const int16_t *restrict direction,
                                          const int16_t *restrict row, size_t rows, size_t stride,
                                          float *restrict out)
{
    const double unit = 1 / (VDNA_DIRECTION_LENGTH * VDNA_DIRECTION_LENGTH);
    for (size_t r = 0; r < rows; r++, row += stride) {
        int32_t product = 0;
        for (size_t i = 0; i < stride; i++)
            product += (int32_t)direction[i] * row[i];
        out[r] = (float)within_0_and_2(1 - product * unit);
    }
}

static void take_distances(vdna_localise *localise, const float *embedding)
{
    const vdna_localise_map *map = localise->map;
    vdna_take_direction(map, embedding, localise->mean, localise->direction);
    row_distances(localise->direction, map->rows, map->frames, map->stride, localise->distances);
}

/* Step the filter unless the robot stands, and tell the nearest frame in any case. */
static void answer_of(vdna_localise *localise, int is_moving_now, vdna_localise_answer *out_answer)
{
    const vdna_row_contrast contrast =
        vdna_row_contrast_of(localise->distances, localise->map->frames);
    vdna_localise_answer *const answer = &localise->answer;
    answer->moving = is_moving_now != 0;
    answer->nearest = contrast.nearest;
    answer->nearest_distance = contrast.least;
    if (is_moving_now)
        vdna_place_filter_step(&localise->filter, localise->distances, &contrast, answer);
    *out_answer = *answer;
}

/* ---- Verbs ---- */

/* see vdna/localise.h */
vdna_status vdna_localise_warm_up(vdna_localise *localise, const float *embedding)
{
    if (!localise || !embedding)
        return VDNA_ERR_ARG;
    if (!vdna_all_finite(embedding, localise->map->dim))
        return VDNA_ERR_NONFINITE;
    take_into_mean(localise, embedding);
    return VDNA_OK;
}

/* see vdna/localise.h */
vdna_status vdna_localise_feed(vdna_localise *localise, const float *embedding,
                               vdna_localise_answer *out_answer)
{
    if (!localise || !embedding || !out_answer)
        return VDNA_ERR_ARG;
    if (!vdna_all_finite(embedding, localise->map->dim))
        return VDNA_ERR_NONFINITE;
    const int has_moved = take_into_mean(localise, embedding);
    take_distances(localise, embedding);
    answer_of(localise, has_moved, out_answer);
    return VDNA_OK;
}

/* see vdna/localise.h */
vdna_status vdna_localise_feed_distances(vdna_localise *localise, const float *distances,
                                         vdna_localise_answer *out_answer)
{
    if (!localise || !distances || !out_answer)
        return VDNA_ERR_ARG;
    for (size_t i = 0; i < localise->map->frames; i++)
        if (!is_within(distances[i], -1e18, 1e18))
            return VDNA_ERR_NONFINITE;
    memcpy(localise->distances, distances, localise->map->frames * sizeof *distances);
    answer_of(localise, 1, out_answer);
    return VDNA_OK;
}

/* ---- Accessors ---- */

/* see vdna/localise.h */
uint32_t vdna_localise_frames(const vdna_localise *localise)
{
    return localise ? localise->map->frames : 0;
}

/* see vdna/localise.h */
uint32_t vdna_localise_dim(const vdna_localise *localise)
{
    return localise ? localise->map->dim : 0;
}

/* see vdna/localise.h */
const float *vdna_localise_distances(const vdna_localise *localise)
{
    return localise ? localise->distances : NULL;
}

/* see vdna/localise.h */
void vdna_localise_posterior(const vdna_localise *localise, double *out)
{
    if (!localise || !out)
        return;
    const vdna_place_filter *filter = &localise->filter;
    for (size_t i = 0; i < filter->frames; i++)
        out[i] = filter->scale * filter->places[i];
}

/* see vdna/localise.h */
const double *vdna_localise_mean(const vdna_localise *localise)
{
    return localise ? localise->mean : NULL;
}

/* see vdna/localise.h */
double vdna_localise_evidence(const vdna_localise *localise)
{
    return localise ? localise->filter.evidence : 0;
}

/* see vdna/localise.h */
uint32_t vdna_localise_jumps(const vdna_localise *localise)
{
    uint32_t count = 0;
    for (uint64_t left = localise ? localise->filter.jumps : 0; left > 0; left &= left - 1)
        count++;
    return count;
}
