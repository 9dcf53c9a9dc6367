/* A network, decoding and frame health for Python: their headers without their structs. */
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

/* see frame.h */
vdna_status bench_decoder_open(vdna_decoder **out_decoder)
{
    return vdna_decoder_open(VDNA_IMAGE_PIXELS_MAX, NULL, out_decoder);
}

/* see frame.h */
vdna_status bench_decode(vdna_decoder *decoder, const uint8_t *data, size_t size)
{
    const vdna_image image = {data, size, 0, 0, 0, VDNA_PIXEL_ENCODED};
    vdna_pixels pixels;
    return vdna_decoder_decode(decoder, &image, NULL, &pixels);
}

/* see frame.h */
vdna_status bench_health(const uint8_t *rgb, uint32_t width, uint32_t height)
{
    const vdna_pixels pixels = {rgb, (size_t)3 * width, width, height, 3, {0, 1, 2}};
    vdna_health health;
    vdna_health_picture picture;
    vdna_health_init(&health, NULL); /* cannot fail: the defaults are valid */
    const vdna_status status = vdna_health_measure(&pixels, &picture);
    if (status == VDNA_OK)
        vdna_health_take(&health, &picture);
    return status;
}
