#include "stub_backbone.h"
#include "map_files.h"
#include <stdatomic.h>
#include <stdbool.h>
#include <time.h>

struct vdna_backbone {
    atomic_bool cancelled;
    long sleep_us;
    vdna_activations taps[2];
    float embedding[5];
};

void (*stub_backbone_ran)(void);

static const float mid[8] = {-1, -0.5f, 0, 0.5f, 1, 2, 3, 4};
static const float top[1] = {0.25f};

void vdna_backbone_config_init(vdna_backbone_config *config)
{
    memset(config, 0, sizeof *config);
    config->struct_size = sizeof *config;
    config->threads = 2;
    config->max_pixels = VDNA_IMAGE_PIXELS_MAX;
}

vdna_status vdna_backbone_open(const vdna_backbone_config *config, vdna_error *error,
                               vdna_backbone **out_backbone)
{
    (void)config;
    (void)error;
    vdna_backbone *backbone = calloc(1, sizeof *backbone);
    if (!backbone)
        return VDNA_ERR_NOMEM;
    const char *sleep_us = getenv("VDNA_STUB_US");
    backbone->sleep_us = sleep_us ? atol(sleep_us) : 0;
    backbone->taps[0] = (vdna_activations){mid, 2, 4, VDNA_LAYOUT_SAMPLES_NEURONS};
    backbone->taps[1] = (vdna_activations){top, 1, 1, VDNA_LAYOUT_SAMPLES_NEURONS};
    backbone->embedding[0] = 1;
    *out_backbone = backbone;
    return VDNA_OK;
}

void vdna_backbone_close(vdna_backbone *backbone)
{
    free(backbone);
}

void vdna_backbone_describe(const vdna_backbone *backbone, vdna_backbone_info *out_info)
{
    (void)backbone;
    const vdna_experience map = sample_experience();
    memset(out_info, 0, sizeof *out_info);
    out_info->identity = map.identity;
    out_info->identity.bins = 0;
    out_info->identity.range = NULL;
    strcpy(out_info->runtime, "none");
    out_info->tap_count = 2;
}

static int64_t monotonic_us(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

vdna_status vdna_backbone_run(vdna_backbone *backbone, const vdna_image *image, vdna_error *error,
                              vdna_backbone_frame *out_frame)
{
    (void)image;
    (void)error;
    const int64_t begin_us = monotonic_us();
    const struct timespec nap = {backbone->sleep_us / 1000000, backbone->sleep_us % 1000000 * 1000};
    if (backbone->sleep_us > 0)
        nanosleep(&nap, NULL);
    if (atomic_load(&backbone->cancelled))
        return VDNA_ERR_RUNTIME;
    *out_frame = (vdna_backbone_frame){
        .taps = backbone->taps,
        .embedding = backbone->embedding,
        .tap_count = 2,
        .dim = 5,
        .inference_us = (uint32_t)(monotonic_us() - begin_us),
    };
    if (stub_backbone_ran)
        stub_backbone_ran();
    return VDNA_OK;
}

void vdna_backbone_cancel(vdna_backbone *backbone)
{
    atomic_store(&backbone->cancelled, true);
}
