#include <fail.h>
#include <inttypes.h>
#include <string.h>

#include <vdna/identity.h>

/* Most characters shown of a value: two values and the caller's words must fit a vdna_error. */
#define SHOWN 100u

/* Characters kept before the first difference when a value is cut. */
#define KEPT 20u

/* Offset from which two values are shown: long values that begin alike are cut at the front. */
static size_t shown_from(const char *of_a, const char *of_b)
{
    size_t same = 0;
    while (of_a[same] != '\0' && of_a[same] == of_b[same])
        same++;
    const int is_long = strlen(of_a) > SHOWN || strlen(of_b) > SHOWN;
    return is_long && same > KEPT ? same - KEPT : 0;
}

static vdna_status differ(const char *field, const char *of_a, const char *of_b, vdna_error *error)
{
    const size_t from = shown_from(of_a, of_b);
    const char *const cut = from > 0 ? "..." : "";
    return vdna_fail(error, VDNA_ERR_MISMATCH, "%s is %s%.*s in one and %s%.*s in the other", field,
                     cut, (int)SHOWN, of_a + from, cut, (int)SHOWN, of_b + from);
}

static vdna_status compare_texts(const char *field, const char *of_a, const char *of_b,
                                 vdna_error *error)
{
    return strcmp(of_a, of_b) == 0 ? VDNA_OK : differ(field, of_a, of_b, error);
}

/* Compare numbers; 0 means "not known yet". */
static vdna_status compare_numbers(const char *field, uint32_t of_a, uint32_t of_b,
                                   vdna_error *error)
{
    if (of_a == of_b || of_a == 0 || of_b == 0)
        return VDNA_OK;
    char text_a[16], text_b[16];
    snprintf(text_a, sizeof text_a, "%" PRIu32, of_a);
    snprintf(text_b, sizeof text_b, "%" PRIu32, of_b);
    return differ(field, text_a, text_b, error);
}

static const char *embedding_of(const vdna_identity *identity)
{
    return identity->embedding[0] != '\0' ? identity->embedding : "one whole output";
}

/* The definition of an embedding is known where its size is. */
static vdna_status compare_embeddings(const vdna_identity *a, const vdna_identity *b,
                                      vdna_error *error)
{
    if (a->dim == 0 || b->dim == 0)
        return VDNA_OK;
    return compare_texts("embedding", embedding_of(a), embedding_of(b), error);
}

/* Numbers that the network gives, of which a projection keeps some. */
static uint32_t raw_dim_of(const vdna_identity *identity)
{
    return identity->projection ? identity->raw_dim : identity->dim;
}

static vdna_status compare_models(const vdna_identity *a, const vdna_identity *b, vdna_error *error)
{
    if (strcmp(a->model_sha256, b->model_sha256) == 0)
        return VDNA_OK;
    /* If precision explains the difference, report it instead of the hashes. */
    const vdna_status status =
        compare_texts("precision", vdna_identity_precision(a), vdna_identity_precision(b), error);
    return status == VDNA_OK ? differ("model_sha256", a->model_sha256, b->model_sha256, error)
                             : status;
}

static vdna_status compare_ranges(const vdna_identity *a, const vdna_identity *b, vdna_error *error)
{
    if (!a->range || !b->range)
        return VDNA_OK;
    /* Bitwise, as histograms compare ranges. */
    for (uint32_t n = 0; n < a->neurons; n++) {
        const float *ra = a->range + 2 * (size_t)n, *rb = b->range + 2 * (size_t)n;
        /* NOLINTNEXTLINE(*-memory-comparison,cert-exp42-c,cert-flp37-c): see above */
        if (memcmp(ra, rb, 2 * sizeof(float)) == 0)
            continue;
        char field[32], of_a[48], of_b[48];
        snprintf(field, sizeof field, "range of neuron %" PRIu32, n);
        snprintf(of_a, sizeof of_a, "%.9g..%.9g", (double)ra[0], (double)ra[1]);
        snprintf(of_b, sizeof of_b, "%.9g..%.9g", (double)rb[0], (double)rb[1]);
        return differ(field, of_a, of_b, error);
    }
    return VDNA_OK;
}

/* Compare directions, of equally many numbers. */
static vdna_status compare_directions(const vdna_identity *a, const vdna_identity *b,
                                      vdna_error *error)
{
    for (size_t n = 0; n < (size_t)a->dim * a->raw_dim; n++) {
        /* NOLINTNEXTLINE(*-memory-comparison,cert-exp42-c,cert-flp37-c): bitwise, as ranges */
        if (memcmp(a->projection + n, b->projection + n, sizeof(float)) == 0)
            continue;
        char field[72], of_a[24], of_b[24];
        snprintf(field, sizeof field, "number %zu of direction %zu of the projection",
                 n % a->raw_dim, n / a->raw_dim);
        snprintf(of_a, sizeof of_a, "%.9g", (double)a->projection[n]);
        snprintf(of_b, sizeof of_b, "%.9g", (double)b->projection[n]);
        return differ(field, of_a, of_b, error);
    }
    return VDNA_OK;
}

static void print_projection(const vdna_identity *identity, char out_text[64])
{
    if (identity->projection)
        snprintf(out_text, 64, "of %" PRIu32 " numbers to %" PRIu32, identity->raw_dim,
                 identity->dim);
    else
        memcpy(out_text, "none", sizeof "none");
}

/* The projection, or that there is none, is known where the range is. */
static vdna_status compare_projections(const vdna_identity *a, const vdna_identity *b,
                                       vdna_error *error)
{
    if (!a->range || !b->range)
        return VDNA_OK;
    char of_a[64], of_b[64];
    print_projection(a, of_a);
    print_projection(b, of_b);
    const vdna_status status = compare_texts("projection", of_a, of_b, error);
    return status == VDNA_OK && a->projection ? compare_directions(a, b, error) : status;
}

/* see vdna/identity.h */
vdna_status vdna_identity_compare(const vdna_identity *a, const vdna_identity *b, vdna_error *error)
{
    if (!a || !b)
        return vdna_fail(error, VDNA_ERR_ARG, "an identity to compare is missing");
    vdna_status status = compare_models(a, b, error);
    if (status == VDNA_OK)
        status = compare_texts("preprocessing", a->preprocessing, b->preprocessing, error);
    if (status == VDNA_OK)
        status = compare_texts("taps", a->taps, b->taps, error);
    if (status == VDNA_OK)
        status = compare_numbers("neurons", a->neurons, b->neurons, error);
    if (status == VDNA_OK)
        status = compare_embeddings(a, b, error);
    if (status == VDNA_OK)
        status = compare_numbers("dim", raw_dim_of(a), raw_dim_of(b), error);
    if (status == VDNA_OK)
        status = compare_numbers("bins", a->bins, b->bins, error);
    if (status == VDNA_OK)
        status = compare_ranges(a, b, error);
    return status == VDNA_OK ? compare_projections(a, b, error) : status;
}
