/* backbone NETWORK: a user's program that runs a picture of one black and one white pixel, and
 * prints what came of it. */
#include <stdio.h>

#include <vdna/backbone.h>
#include <vdna/picture.h>

static int fail(const vdna_error *error)
{
    fprintf(stderr, "%s\n", error->text);
    return 1;
}

int main(int argc, char **argv)
{
    static const uint8_t pixels[] = {0, 0, 0, 255, 255, 255};
    const vdna_image image = {pixels, sizeof pixels, 2, 1, 0, VDNA_PIXEL_RGB3};
    vdna_backbone_config config;
    vdna_backbone_config_init(&config);
    config.manifest = argc > 1 ? argv[1] : "";
    vdna_error error;
    vdna_backbone *backbone;
    if (vdna_backbone_open(&config, &error, &backbone) != VDNA_OK)
        return fail(&error);
    vdna_backbone_info info;
    vdna_backbone_describe(backbone, &info);
    vdna_backbone_frame frame;
    if (vdna_backbone_run(backbone, &image, &error, &frame) != VDNA_OK)
        return fail(&error);
    printf("%s %s\n%g %g %g\n%s\n", info.identity.backbone, info.identity.taps,
           (double)frame.embedding[0], (double)frame.embedding[frame.dim - 1], (double)frame.grey,
           vdna_status_text(VDNA_OK));
    vdna_backbone_close(backbone);
    return vdna_decoder_bytes_max(2) > 0 ? 0 : 1;
}
