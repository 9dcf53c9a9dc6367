#include <fail.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include <vdna/hist.h>
#include <vdna/identity.h>

#include "text.h"

static int is_hex(char c)
{
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
}

/* see vdna/identity.h */
const char *vdna_identity_precision(const vdna_identity *identity)
{
    return identity && identity->precision[0] != '\0' ? identity->precision
                                                      : VDNA_PRECISION_DEFAULT;
}

/* see vdna/identity.h */
int vdna_identity_is_centred(const vdna_identity *identity)
{
    static const char word[] = " centred";
    const size_t length = identity ? strlen(identity->embedding) : 0;
    return length > strlen(word) && strcmp(identity->embedding + length - strlen(word), word) == 0;
}

static vdna_status check_sha256(const char text[VDNA_SHA256_SIZE], vdna_error *error)
{
    for (size_t i = 0; i < VDNA_SHA256_SIZE; i++)
        if (i == VDNA_SHA256_SIZE - 1 ? text[i] != '\0' : !is_hex(text[i]))
            return vdna_fail(error, VDNA_ERR_ARG,
                             "model_sha256 is not 64 lower-case hexadecimal digits");
    return VDNA_OK;
}

static vdna_status check_texts(const vdna_identity *i, vdna_error *error)
{
    static const char *const printable = "printable ASCII characters";
    vdna_status status = vdna_text_check_name("backbone ", i->backbone, sizeof i->backbone, error);
    if (status == VDNA_OK)
        status = vdna_text_check("preprocessing ", i->preprocessing, sizeof i->preprocessing,
                                 vdna_is_printable, printable, error);
    if (status == VDNA_OK && i->precision[0] != '\0')
        status = vdna_text_check_name("precision ", i->precision, sizeof i->precision, error);
    if (status == VDNA_OK)
        status =
            vdna_text_check("taps ", i->taps, sizeof i->taps, vdna_is_printable, printable, error);
    if (status == VDNA_OK && i->embedding[0] != '\0')
        status = vdna_text_check("embedding ", i->embedding, sizeof i->embedding, vdna_is_printable,
                                 printable, error);
    return status == VDNA_OK ? check_sha256(i->model_sha256, error) : status;
}

static vdna_status check_taps(const vdna_identity *i, vdna_error *error)
{
    uint64_t neurons = 0;
    const char *rest = i->taps;
    vdna_tap tap;
    vdna_status status;
    /* A text of VDNA_TAPS_SIZE has fewer than 2^9 taps, so their sum cannot wrap. */
    while ((status = vdna_taps_next(&rest, &tap)) == VDNA_OK)
        neurons += tap.neurons;
    if (status != VDNA_ERR_EMPTY)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "taps is \"%.200s\", expected NAME:NEURONS:SAMPLES, comma, ...", i->taps);
    if (neurons != i->neurons)
        return vdna_fail(error, VDNA_ERR_MISMATCH,
                         "the taps \"%.200s\" do not have the %" PRIu32 " neurons of the counts",
                         i->taps, i->neurons);
    return VDNA_OK;
}

static vdna_status check_bins(const vdna_identity *i, vdna_error *error)
{
    if (i->bins == 0 || (i->bins >= VDNA_HIST_BINS_MIN && i->bins <= VDNA_HIST_BINS_MAX))
        return VDNA_OK;
    return vdna_fail(error, VDNA_ERR_ARG, "bins is %" PRIu32 ", expected %u to %u", i->bins,
                     VDNA_HIST_BINS_MIN, VDNA_HIST_BINS_MAX);
}

static vdna_status check_range(const vdna_identity *i, vdna_error *error)
{
    for (size_t n = 0; i->range && n < i->neurons; n++)
        if (vdna_range_check(i->range + 2 * n, 1) != VDNA_OK)
            return vdna_fail(error, VDNA_ERR_ARG,
                             "the range of neuron %zu is %g..%g, expected finite numbers, the"
                             " first below the second",
                             n, (double)i->range[2 * n], (double)i->range[2 * n + 1]);
    return VDNA_OK;
}

static vdna_status check_projection(const vdna_identity *i, vdna_error *error)
{
    if (!i->projection != (i->raw_dim == 0) ||
        (i->projection && (i->dim == 0 || i->dim > i->raw_dim)))
        return vdna_fail(error, VDNA_ERR_ARG,
                         "the projection has %s and makes %" PRIu32 " of %" PRIu32
                         " numbers, expected 1 to all of them, or 0 and no directions",
                         i->projection ? "directions" : "no directions", i->dim, i->raw_dim);
    for (size_t n = 0; i->projection && n < (size_t)i->dim * i->raw_dim; n++)
        if (!isfinite(i->projection[n]))
            return vdna_fail(error, VDNA_ERR_ARG,
                             "direction %zu of the projection has a NaN or an infinity",
                             n / i->raw_dim);
    return VDNA_OK;
}

/* see vdna/identity.h */
vdna_status vdna_identity_check(const vdna_identity *identity, vdna_error *error)
{
    if (!identity)
        return vdna_fail(error, VDNA_ERR_ARG, "the identity to check is missing");
    static vdna_status (*const checks[])(const vdna_identity *, vdna_error *) = {
        check_texts, check_taps, check_bins, check_range, check_projection};
    for (size_t c = 0; c < sizeof checks / sizeof *checks; c++) {
        const vdna_status status = checks[c](identity, error);
        if (status != VDNA_OK)
            return status;
    }
    return VDNA_OK;
}
