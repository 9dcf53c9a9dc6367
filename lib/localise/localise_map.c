#include "localise_map.h"

#include <math.h>

#include "elementary.h"
#include "growth.h"

/* Bytes of vdna_localise_map_config in the version that brought it. */
#define OLDEST_MAP_CONFIG sizeof(vdna_localise_map_config)

static const vdna_localise_map_config map_defaults = {.centred = 1};

/* see vdna/localise.h */
void vdna_localise_map_config_init(vdna_localise_map_config *config)
{
    vdna_config_write(config, OLDEST_MAP_CONFIG, &map_defaults, sizeof map_defaults);
}

static size_t stride_of(uint32_t dim)
{
    return (size_t)dim + dim % 2;
}

/* Read and check a config, all but its embeddings.
 * @param out_config  complete
 * @return bytes of the caller's block; 0 if a field breaks its rule or they are beyond size_t */
static size_t read_map_config(const vdna_localise_map_config *given,
                              vdna_localise_map_config *out_config)
{
    *out_config = map_defaults;
    if (!vdna_config_read(given, OLDEST_MAP_CONFIG, out_config, sizeof *out_config))
        return 0;
    const size_t frames = out_config->frames, dim = out_config->dim;
    if (frames == 0 || dim == 0 || dim > VDNA_LOCALISE_DIM_MAX || out_config->centred > 1)
        return 0;
    const size_t room = SIZE_MAX - sizeof(vdna_localise_map) - dim * sizeof(double);
    const size_t row = stride_of(out_config->dim) * sizeof(int16_t);
    return frames > room / row ? 0 : SIZE_MAX - room + frames * row;
}

/* see vdna/localise.h */
size_t vdna_localise_map_mem_size(const vdna_localise_map_config *config)
{
    vdna_localise_map_config complete;
    return read_map_config(config, &complete);
}

/* see localise_map.h */
int vdna_all_finite(const float *values, size_t count)
{
    int finite = 1;
    for (size_t i = 0; i < count; i++)
        finite &= isfinite(values[i]) != 0;
    return finite;
}

/* see localise_map.h */
void vdna_take_direction(const vdna_localise_map *map, const float *frame, const double *mean,
                         int16_t *out)
{
    double sum = 0;
    for (size_t i = 0; i < map->dim; i++)
        sum += (frame[i] - mean[i]) * (frame[i] - mean[i]);
    const double length = vdna_sqrt(sum);
    const double scale = VDNA_DIRECTION_LENGTH / (length < 1e-12 ? 1e-12 : length);
    for (size_t i = 0; i < map->dim; i++) {
        const double value = (frame[i] - mean[i]) * scale;
        out[i] = (int16_t)(int32_t)(value + (value < 0 ? -0.5 : 0.5));
    }
    if (map->stride > map->dim)
        out[map->dim] = 0;
}

static void take_mean(vdna_localise_map *map, const float *embeddings)
{
    for (size_t i = 0; i < map->dim; i++)
        map->mean[i] = 0;
    if (!map->centred)
        return;
    for (size_t f = 0; f < map->frames; f++)
        for (size_t i = 0; i < map->dim; i++)
            map->mean[i] += embeddings[f * map->dim + i];
    for (size_t i = 0; i < map->dim; i++)
        map->mean[i] /= map->frames;
}

/* The value that `rank` of the `count` values are below, none of them negative. Bisects the order
 * of floats as integers: it needs no room, and its time does not depend on the values. */
static double value_of_rank(const float *values, size_t count, size_t rank)
{
    uint32_t least = 0, most = 0x7f7fffff; /* bits of 0 and of the greatest float */
    while (least < most) {
        const uint32_t middle = least + (most - least) / 2;
        float limit;
        memcpy(&limit, &middle, sizeof limit);
        size_t within = 0;
        for (size_t i = 0; i < count; i++)
            within += values[i] <= limit;
        if (within > rank)
            most = middle;
        else
            least = middle + 1;
    }
    float found;
    memcpy(&found, &least, sizeof found);
    return found;
}

static float distance_of(const float *a, const float *b, size_t dim)
{
    double sum = 0;
    for (size_t i = 0; i < dim; i++) {
        const double difference = (double)a[i] - b[i];
        sum += difference * difference;
    }
    const double distance = vdna_sqrt(sum), greatest = 0x1.fffffep127;
    return (float)(distance < greatest ? distance : greatest);
}

/* The rows are at least as wide as a float, so the steps fit there until the rows are made. */
static void take_step(vdna_localise_map *map, const float *embeddings)
{
    const size_t count = map->frames - 1, dim = map->dim;
    float *const steps = (float *)(void *)map->rows;
    for (size_t i = 0; i < count; i++)
        steps[i] = distance_of(embeddings + (i + 1) * dim, embeddings + i * dim, dim);
    map->step = 0;
    if (count > 0)
        map->step = (value_of_rank(steps, count, (count - 1) / 2) +
                     value_of_rank(steps, count, count / 2)) /
                    2;
}

/* see vdna/localise.h */
vdna_status vdna_localise_map_init(const vdna_localise_map_config *config, void *mem,
                                   size_t mem_size, vdna_localise_map **out_map)
{
    vdna_localise_map_config complete;
    const size_t size = read_map_config(config, &complete);
    if (size == 0 || !complete.embeddings || !mem || !out_map ||
        (uintptr_t)mem % sizeof(int64_t) != 0)
        return VDNA_ERR_ARG;
    if (mem_size < size)
        return VDNA_ERR_NOMEM;
    if (!vdna_all_finite(complete.embeddings, (size_t)complete.frames * complete.dim))
        return VDNA_ERR_NONFINITE;

    vdna_localise_map *map = mem;
    map->frames = complete.frames;
    map->dim = complete.dim;
    map->stride = stride_of(complete.dim);
    map->centred = complete.centred;
    map->mean = (double *)(void *)(map + 1);
    map->rows = (int16_t *)(void *)(map->mean + map->dim);
    take_mean(map, complete.embeddings);
    take_step(map, complete.embeddings);
    for (size_t f = 0; f < map->frames; f++)
        vdna_take_direction(map, complete.embeddings + f * map->dim, map->mean,
                            map->rows + f * map->stride);
    *out_map = map;
    return VDNA_OK;
}

/* see vdna/localise.h */
double vdna_localise_map_step(const vdna_localise_map *map)
{
    return map ? map->step : 0;
}

/* see vdna/localise.h */
const double *vdna_localise_map_mean(const vdna_localise_map *map)
{
    return map ? map->mean : NULL;
}
