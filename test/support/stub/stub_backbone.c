/* A plug-in without a network, for tests of everything around one. It fits the map of map_files.h,
 * gives the same numbers for every picture, and takes $VDNA_STUB_US microseconds (default 0) asleep
 * for each. */
#include <stdatomic.h>
#include <stdbool.h>
#include <time.h>

#include <vdna/backbone.h>

#include "map_files.h"

typedef struct stub {
    atomic_bool cancelled;
    long sleep_us;
    vdna_activations taps[2];
    float embedding[5];
} stub;

static const float mid[8] = {-1, -0.5f, 0, 0.5f, 1, 2, 3, 4};
static const float top[1] = {0.25f};

static vdna_status stub_open(const vdna_backbone_config *config, vdna_error *error,
                             void **out_state)
{
    (void)config;
    (void)error;
    stub *opened = calloc(1, sizeof *opened);
    if (!opened)
        return VDNA_ERR_NOMEM;
    const char *sleep_us = getenv("VDNA_STUB_US");
    opened->sleep_us = sleep_us ? atol(sleep_us) : 0;
    opened->taps[0] = (vdna_activations){mid, 2, 4, VDNA_LAYOUT_SAMPLES_NEURONS};
    opened->taps[1] = (vdna_activations){top, 1, 1, VDNA_LAYOUT_SAMPLES_NEURONS};
    opened->embedding[0] = 1;
    *out_state = opened;
    return VDNA_OK;
}

static void stub_describe(const void *state, vdna_backbone_info *out_info)
{
    (void)state;
    out_info->identity = sample_experience().identity;
    strcpy(out_info->runtime, "none");
    out_info->tap_count = 2;
}

static int64_t monotonic_us(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

static vdna_status stub_run(void *state, const vdna_image *image, vdna_error *error,
                            vdna_backbone_frame *out_frame)
{
    (void)image;
    (void)error;
    const stub *opened = state;
    const int64_t begin_us = monotonic_us();
    const struct timespec nap = {opened->sleep_us / 1000000, opened->sleep_us % 1000000 * 1000};
    if (opened->sleep_us > 0)
        nanosleep(&nap, NULL);
    if (atomic_load(&opened->cancelled))
        return VDNA_ERR_RUNTIME;
    out_frame->taps = opened->taps;
    out_frame->tap_count = 2;
    out_frame->embedding = opened->embedding;
    out_frame->dim = 5;
    out_frame->inference_us = (uint32_t)(monotonic_us() - begin_us);
    return VDNA_OK;
}

static void stub_cancel(void *state)
{
    atomic_store(&((stub *)state)->cancelled, true);
}

const vdna_backbone_operations *vdna_backbone_plugin(void)
{
    static const vdna_backbone_operations table = {
        .struct_size = sizeof table,
        .version = VDNA_BACKBONE_OPERATIONS,
        .open = stub_open,
        .close = free,
        .describe = stub_describe,
        .run = stub_run,
        .cancel = stub_cancel,
    };
    return &table;
}
