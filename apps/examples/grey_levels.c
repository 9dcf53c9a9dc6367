/* A network of your own, as a plug-in: how much of a picture has each of 16 grey levels. */
#include <stdlib.h>
#include <string.h>

#include <vdna/backbone.h>
#include <vdna/picture.h>

enum { LEVELS = 16 };

typedef struct network {
    vdna_decoder *decoder;
    uint64_t decode_bytes;
    float share[LEVELS]; /* of the last picture: the tap, and the embedding as well */
    vdna_activations tap;
} network;

static vdna_status start(const vdna_backbone_config *config, vdna_error *error, void **out_state)
{
    network *net = calloc(1, sizeof *net);
    if (!net || vdna_decoder_open(config->max_pixels, error, &net->decoder) != VDNA_OK)
        return free(net), VDNA_ERR_NOMEM;
    net->decode_bytes = vdna_decoder_bytes_max(config->max_pixels);
    net->tap = (vdna_activations){net->share, LEVELS, 1, VDNA_LAYOUT_SAMPLES_NEURONS};
    return *out_state = net, VDNA_OK;
}

static void stop(void *state)
{
    vdna_decoder_close(((network *)state)->decoder);
    free(state);
}

static void describe(const void *state, vdna_backbone_info *info)
{
    info->identity = (vdna_identity){.backbone = "grey_levels",
                                     .preprocessing = "none",
                                     .taps = "levels:16:1",
                                     .neurons = LEVELS,
                                     .dim = LEVELS};
    memset(info->identity.model_sha256, '1', 64); /* another one whenever its numbers change */
    info->tap_count = 1;
    info->decode_bytes = ((const network *)state)->decode_bytes;
}

static vdna_status run(void *state, const vdna_image *image, vdna_error *error,
                       vdna_backbone_frame *out)
{
    network *net = state;
    vdna_pixels p;
    const vdna_status status = vdna_decoder_decode(net->decoder, image, error, &p);
    if (status != VDNA_OK)
        return status;
    unsigned count[LEVELS] = {0};
    for (size_t i = 0; i < (size_t)p.width * p.height; i++) {
        const uint8_t *at = p.data + i / p.width * p.stride + i % p.width * p.channels;
        count[(at[p.rgb[0]] + at[p.rgb[1]] + at[p.rgb[2]]) * LEVELS / (3 * 256)]++;
    }
    for (int i = 0; i < LEVELS; i++)
        net->share[i] = (float)count[i] / (float)p.width / (float)p.height;
    const float grey = vdna_pixels_mean_grey(&p);
    *out = (vdna_backbone_frame){
        .taps = &net->tap, .embedding = net->share, .tap_count = 1, .dim = LEVELS, .grey = grey};
    return VDNA_OK;
}

static void cancel(void *state)
{
    (void)state; /* a run ends soon by itself */
}

const vdna_backbone_operations *vdna_backbone_plugin(void)
{
    static const vdna_backbone_operations table = {
        sizeof table, VDNA_BACKBONE_OPERATIONS, start, stop, describe, run, cancel};
    return &table;
}
