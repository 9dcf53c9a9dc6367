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
    if (frames == 0 || dim == 0 || out_config->centred > 1)
        return 0;
    const size_t room = SIZE_MAX - sizeof(vdna_localise_map);
    if (dim > room / sizeof(double) || frames > (room - dim * sizeof(double)) / sizeof(float) / dim)
        return 0;
    return sizeof(vdna_localise_map) + dim * sizeof(double) + frames * dim * sizeof(float);
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
double vdna_unit_scale(double length_sq)
{
    const double length = vdna_sqrt(length_sq);
    return 1 / (length < 1e-12 ? 1e-12 : length);
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

/* The rows have room for the steps until they are made. */
static void take_step(vdna_localise_map *map, const float *embeddings)
{
    const size_t steps = map->frames - 1, dim = map->dim;
    for (size_t i = 0; i < steps; i++)
        map->rows[i] = distance_of(embeddings + (i + 1) * dim, embeddings + i * dim, dim);
    map->step = 0;
    if (steps > 0)
        map->step = (value_of_rank(map->rows, steps, (steps - 1) / 2) +
                     value_of_rank(map->rows, steps, steps / 2)) /
                    2;
}

static void make_rows(vdna_localise_map *map, const float *embeddings)
{
    float *row = map->rows;
    for (size_t f = 0; f < map->frames; f++, embeddings += map->dim, row += map->dim) {
        double sum = 0;
        for (size_t i = 0; i < map->dim; i++)
            sum += (embeddings[i] - map->mean[i]) * (embeddings[i] - map->mean[i]);
        const double scale = vdna_unit_scale(sum);
        for (size_t i = 0; i < map->dim; i++)
            row[i] = (float)((embeddings[i] - map->mean[i]) * scale);
    }
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
    map->centred = complete.centred;
    map->mean = (double *)(void *)(map + 1);
    map->rows = (float *)(void *)(map->mean + map->dim);
    take_mean(map, complete.embeddings);
    take_step(map, complete.embeddings);
    make_rows(map, complete.embeddings);
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

/* see vdna/localise.h */
const float *vdna_localise_map_rows(const vdna_localise_map *map)
{
    return map ? map->rows : NULL;
}
