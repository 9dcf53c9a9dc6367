#include <fail.h>
#include <string.h>

#include <vdna/map.h>

/* see vdna/map.h */
vdna_status vdna_experience_compare(const vdna_experience *a, const vdna_experience *b,
                                    vdna_error *error)
{
    if (!a || !b)
        return vdna_fail(error, VDNA_ERR_ARG, "experiences to compare must not be NULL");
    vdna_error reason;
    const vdna_status status = vdna_identity_compare(&a->identity, &b->identity, &reason);
    if (status != VDNA_OK)
        return vdna_fail(error, status,
                         "experiences %s and %s do not compare: %s; rebuild one of them with `vdna"
                         " build`, with the backbone, bins and ranges of the other",
                         a->name, b->name, reason.text);
    return VDNA_OK;
}

/* see vdna/map.h */
void vdna_experience_view(const vdna_experience *experience, vdna_hist_view *out_view)
{
    if (!experience || !out_view)
        return;
    out_view->range = experience->identity.range;
    out_view->counts = experience->counts;
    out_view->mass = experience->mass;
    out_view->neurons = experience->identity.neurons;
    out_view->bins = experience->identity.bins;
}

/* see vdna/map.h */
vdna_status vdna_experience_thumbnail(const vdna_experience *experience, uint32_t frame,
                                      const uint8_t **out_jpeg, size_t *out_size)
{
    if (!experience || !out_jpeg || !out_size || frame >= experience->frames)
        return VDNA_ERR_ARG;
    if (!experience->thumbnails)
        return VDNA_ERR_EMPTY;
    const uint32_t begin = frame > 0 ? experience->thumbnail_end[frame - 1] : 0;
    const uint32_t end = experience->thumbnail_end[frame];
    if (begin == end)
        return VDNA_ERR_EMPTY;
    *out_jpeg = experience->thumbnails + begin;
    *out_size = end - begin;
    return VDNA_OK;
}

/* Whether the definition of an embedding, in words, has the word "last=NAME". */
static int names_last_layer(const char *embedding, const vdna_tap *tap)
{
    static const char key[] = " last=";
    const char *const found = strstr(embedding, key);
    const char *const name = found ? found + sizeof key - 1 : "";
    if (strncmp(name, tap->name, tap->name_length) != 0)
        return 0;
    return name[tap->name_length] == '\0' || name[tap->name_length] == ' ';
}

/* see vdna/map.h */
uint32_t vdna_experience_counts_last_layer(const vdna_experience *experience)
{
    if (!experience || !experience->last_layer)
        return 0;
    const vdna_identity *const identity = &experience->identity;
    const char *rest = identity->taps;
    vdna_tap tap;
    if (vdna_taps_next(&rest, &tap) != VDNA_OK || *rest != '\0')
        return 0;
    return tap.samples == 1 && tap.neurons == experience->last_layer_dim &&
           names_last_layer(identity->embedding, &tap);
}
