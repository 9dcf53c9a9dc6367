/* The bridge for test_map.py: writes the sample experience, or prints one written by others.
 *
 *     experience_dump write|write-codes|write-projected FILE
 *     experience_dump read FILE     a line each: the field's name, then its numbers or its text */
#define _POSIX_C_SOURCE 200809L
#include <inttypes.h>

#include "map_files.h"

static void print_unsigned(const char *name, const uint32_t *numbers, size_t count)
{
    printf("%s", name);
    for (size_t i = 0; i < count; i++)
        printf(" %" PRIu32, numbers[i]);
    printf("\n");
}

static void print_signed(const char *name, const int64_t *numbers, size_t count)
{
    printf("%s", name);
    for (size_t i = 0; numbers && i < count; i++)
        printf(" %" PRId64, numbers[i]);
    printf("\n");
}

static void print_codes(const char *name, const int8_t *codes, size_t count)
{
    printf("%s", name);
    for (size_t i = 0; codes && i < count; i++)
        printf(" %d", codes[i]);
    printf("\n");
}

/* Nine digits tell every float from its neighbours. */
static void print_floats(const char *name, const float *numbers, size_t count)
{
    printf("%s", name);
    for (size_t i = 0; numbers && i < count; i++)
        printf(" %.9g", (double)numbers[i]);
    printf("\n");
}

static void print_doubles(const char *name, const double *numbers, size_t count)
{
    printf("%s", name);
    for (size_t i = 0; numbers && i < count; i++)
        printf(" %.17g", numbers[i]);
    printf("\n");
}

static void print(const vdna_experience *e)
{
    const size_t neurons = e->identity.neurons, frames = e->frames;
    printf("name %s\nbackbone %s\nmodel_sha256 %s\npreprocessing %s\ntaps %s\ncomparable %s\n"
           "position_frame %s\norder %s\nembedding %s\n",
           e->name, e->identity.backbone, e->identity.model_sha256, e->identity.preprocessing,
           e->identity.taps, e->comparable, e->position_frame, e->order, e->identity.embedding);
    print_unsigned("counts", e->counts, e->identity.bins * neurons);
    print_unsigned("mass", e->mass, neurons);
    print_floats("range", e->identity.range, 2 * neurons);
    print_floats("projection", e->identity.projection, e->identity.dim * e->identity.raw_dim);
    print_floats("embeddings", e->embeddings, frames * e->identity.dim);
    print_signed("frame_utime", e->frame_utime, frames);
    print_signed("frame_place", e->frame_place, frames);
    print_doubles("frame_position", e->frame_position, 3 * frames);
    print_floats("frame_grey", e->frame_grey, frames);
    print_codes("frame_embedding", e->embedding_codes, frames * e->identity.dim);
    print_floats("frame_embedding_scale", e->embedding_scale, frames);
    print_codes("frame_last_layer", e->last_layer, frames * e->last_layer_dim);
    print_floats("frame_last_layer_scale", e->last_layer_scale, frames);
}

int main(int argc, char **argv)
{
    vdna_error error;
    const char *const mode = argc == 3 ? argv[1] : "";
    const int writes = strncmp(mode, "write", strlen("write")) == 0;
    vdna_experience e = strcmp(mode, "write-codes") == 0       ? coded_experience()
                        : strcmp(mode, "write-projected") == 0 ? projected_experience()
                                                               : sample_experience();
    if (!writes && strcmp(mode, "read") != 0) {
        fprintf(stderr, "usage: experience_dump write|write-codes|write-projected|read FILE\n");
        return 2;
    }
    const vdna_status status = writes ? vdna_experience_write(&e, argv[2], &error)
                                      : vdna_experience_open(argv[2], &error, &e);
    if (status != VDNA_OK) {
        fprintf(stderr, "%s\n", error.text);
        return EXIT_FAILURE;
    }
    if (!writes)
        print(&e);
    vdna_experience_close(&e);
    return EXIT_SUCCESS;
}
