/* A network for Python: vdna/backbone.h without its structs. */
#include "frame.h"

/* see frame.h */
vdna_status bench_backbone_open(const char *manifest, uint32_t threads, vdna_error *error,
                                vdna_backbone **out_backbone)
{
    vdna_backbone_config config;
    vdna_backbone_config_init(&config);
    config.manifest = manifest;
    config.threads = threads;
    return vdna_backbone_open(&config, error, out_backbone);
}

/* see frame.h */
vdna_status bench_backbone_run(vdna_backbone *backbone, const uint8_t *data, size_t size,
                               uint32_t width, uint32_t height, uint32_t pixelformat,
                               vdna_error *error, uint32_t out_us[3])
{
    const vdna_image image = {data, size, width, height, 0, pixelformat};
    vdna_backbone_frame frame;
    const vdna_status status = vdna_backbone_run(backbone, &image, error, &frame);
    if (status != VDNA_OK)
        return status;
    out_us[0] = frame.decode_us;
    out_us[1] = frame.resize_us;
    out_us[2] = frame.inference_us;
    return VDNA_OK;
}
