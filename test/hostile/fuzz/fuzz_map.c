/* Any bytes as an experience file. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>

#include <vdna/explain.h>

#include "fuzz.h"
#include "layout.h"
#include "map_files.h"
#include "read.h"
#include "right_checksum.h"

/* The identity of an accepted experience is valid, and its taps are written as they are read. */
static void use_identity(const vdna_experience *e)
{
    static char text[VDNA_IDENTITY_TEXT_SIZE];
    char sha256[VDNA_SHA256_SIZE], taps[VDNA_TAPS_SIZE] = "", name[VDNA_NAME_SIZE] = "";
    memcpy(name, e->position_frame, strnlen(e->position_frame, sizeof name - 1));
    MUST(vdna_identity_check(&e->identity, NULL) == VDNA_OK);
    MUST(vdna_identity_hash(&e->identity, sha256) == VDNA_OK);
    MUST(strcmp(sha256, e->comparable) == 0);
    MUST(vdna_identity_text(&e->identity, text) == VDNA_OK && text[0] != '\0');
    MUST(vdna_identity_compare(&e->identity, &e->identity, NULL) == VDNA_OK);
    MUST(vdna_identity_precision(&e->identity)[0] != '\0');
    const char *centred = strstr(e->identity.embedding, "centred");
    MUST(!vdna_identity_is_centred(&e->identity) || centred);
    vdna_name_replace(name);
    MUST(vdna_name_check(name, NULL) == VDNA_OK || name[0] == '\0');
    const char *rest = e->identity.taps;
    for (vdna_tap tap; vdna_taps_next(&rest, &tap) == VDNA_OK;)
        MUST(vdna_taps_append(taps, sizeof taps, &tap) == VDNA_OK);
    MUST(strcmp(taps, e->identity.taps) == 0);
}

/* A position is whole, or absent as a whole, and in a frame with a name. */
static void use_positions(const vdna_experience *e)
{
    MUST(memchr(e->position_frame, '\0', sizeof e->position_frame) != NULL);
    MUST((e->position_frame[0] != '\0') == (e->frame_position != NULL));
    for (size_t i = 0; e->frame_position && i < 3 * (size_t)e->frames; i++)
        MUST(isfinite(e->frame_position[i]) || isnan(e->frame_position[i - i % 3]));
    MUST(memchr(e->order, '\0', sizeof e->order) != NULL);
}

/* Codes are whole rows with their scales, and embeddings are floats however they are stored. */
static void use_codes(const vdna_experience *e)
{
    MUST(!e->last_layer == !e->last_layer_scale && !e->last_layer == (e->last_layer_dim == 0));
    MUST(!e->embedding_codes == !e->embedding_scale);
    uint32_t most = 0, least = 0;
    if (vdna_experience_counts_last_layer(e))
        MUST(vdna_explain_frames(e->last_layer, e->last_layer_scale, e->frames, e->last_layer_dim,
                                 e->identity.neurons - 1, &most, &least) == VDNA_OK &&
             most < e->frames && least < e->frames);
    for (size_t i = 0; e->embeddings && i < (size_t)e->frames * e->identity.dim; i++)
        MUST(isfinite(e->embeddings[i]));
    MUST(e->embeddings || e->embedding_codes);
}

/* A live frame can be projected; the sanitisers watch the reads. */
static void use_projection(const vdna_experience *e)
{
    const size_t raw_dim = e->identity.projection ? e->identity.raw_dim : e->identity.dim;
    float *live = calloc(raw_dim, sizeof *live);
    float *kept = malloc(e->identity.dim * sizeof *kept);
    if (live && kept) {
        MUST(vdna_identity_project(&e->identity, live, kept) == VDNA_OK);
        MUST(kept[e->identity.dim - 1] == 0);
    }
    free(live);
    free(kept);
}

/* Every frame's thumbnail is within all of them; the sanitisers watch the reads. */
static void use_thumbnails(const vdna_experience *e)
{
    uint32_t bytes = 0;
    volatile uint8_t last = 0;
    for (uint32_t f = 0; f < e->frames; f++) {
        const uint8_t *jpeg;
        size_t size;
        const vdna_status status = vdna_experience_thumbnail(e, f, &jpeg, &size);
        MUST(status == VDNA_OK || status == VDNA_ERR_EMPTY);
        if (status != VDNA_OK)
            continue;
        MUST(size > 0 && size <= VDNA_THUMBNAIL_MAX);
        bytes += (uint32_t)size;
        last = jpeg[size - 1];
    }
    (void)last;
    MUST(bytes == e->thumbnail_bytes);
    MUST(memchr(e->source, '\0', sizeof e->source) != NULL);
}

/* Read everything that an accepted experience points to: the reader's promises must hold. */
static void use(const vdna_experience *e)
{
    vdna_hist_view view;
    vdna_experience_view(e, &view);
    const size_t scratch_size = vdna_emd_scratch_size(e->identity.neurons);
    void *scratch = malloc(scratch_size);
    double distance = 0;
    const vdna_status status = vdna_emd_mean(&view, &view, scratch, scratch_size, &distance);
    free(scratch);
    MUST(distance == 0 && (status == VDNA_OK || status == VDNA_ERR_OVERFLOW));
    MUST(vdna_experience_compare(e, e, NULL) == VDNA_OK);
    use_identity(e);
    use_positions(e);
    use_codes(e);
    use_projection(e);
    use_thumbnails(e);

    vdna_field fields[VDNA_FIELD_COUNT];
    vdna_layout_of(e, fields);
    for (size_t f = 0; f < VDNA_FIELD_COUNT; f++) {
        const size_t size = (size_t)vdna_field_elements(&fields[f]) * fields[f].width;
        void *copy = malloc(size);
        if (copy && fields[f].data)
            memcpy(copy, fields[f].data, size);
        free(copy);
    }
}

/* Whatever the header says by itself is text that can be shown, and that of a valid file is what
 * opening it says. @param e  NULL = the file is not valid */
static void use_header(const unsigned char *bytes, size_t size, const vdna_experience *e)
{
    vdna_experience header;
    const vdna_status status = vdna_read_header(bytes, size, NULL, &header);
    MUST(status == VDNA_OK || !e);
    if (status != VDNA_OK)
        return;
    MUST(vdna_name_check(header.name, NULL) == VDNA_OK);
    MUST(vdna_name_check(header.identity.backbone, NULL) == VDNA_OK);
    MUST(!header.identity.range && !header.identity.projection && !header.file_bytes);
    MUST(!e || (strcmp(header.name, e->name) == 0 && header.frames == e->frames &&
                strcmp(header.comparable, e->comparable) == 0));
}

static void read_and_use(const unsigned char *bytes, size_t size)
{
    vdna_experience e;
    vdna_error reason = {""};
    const vdna_status status = vdna_read(bytes, size, VDNA_READ_DECODED, &reason, &e);
    vdna_experience in_place;
    const vdna_status seen = vdna_experience_open_memory(bytes, size, NULL, &in_place);
    MUST(seen == status || status == VDNA_ERR_NOMEM);
    if (seen == VDNA_OK) {
        use(&in_place);
        vdna_experience_close(&in_place);
    }
    use_header(bytes, size, status == VDNA_OK ? &e : NULL);
    if (status != VDNA_OK) {
        MUST(reason.text[0] != '\0');
        return;
    }
    use(&e);
    vdna_read_free(&e);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    try_file(bytes, size, read_and_use);
    return 0;
}

/* The sample, the same without optional fields, with frames without ground truth, with a second
 * embedding, with codes, with a projection, and with thumbnails. */
size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity)
{
    vdna_experience e = sample_experience();
    if (index > 6)
        return 0;
    if (index > 2)
        e = index == 3   ? grid_experience()
            : index == 4 ? coded_experience()
            : index == 5 ? projected_experience()
                         : pictured_experience();
    if (index == 1) {
        e.frame_place = NULL;
        e.frame_position = NULL;
    }
    static const int64_t place[] = {17, VDNA_PLACE_NONE};
    static const double position[] = {NAN, NAN, NAN, 4e6, 4e6, 3e6};
    if (index == 2) {
        e.frame_place = place;
        e.frame_position = position;
        strcpy(e.position_frame, VDNA_FRAME_WGS84);
    }
    const directory made = make_directory();
    const char *path = path_in(&made, "seed");
    MUST(vdna_experience_write(&e, path, NULL) == VDNA_OK);
    const size_t size = load_file(path, out, capacity);
    remove_directory(&made);
    return size;
}
