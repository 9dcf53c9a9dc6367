#include "comparable.h"
#include "precision.h"
#include <fail.h>
#include <inttypes.h>
#include <sha2.h>
#include <string.h>

static void add(SHA2_CTX *hash, const void *bytes, size_t size)
{
    SHA256Update(hash, bytes, size);
}

static void add_line(SHA2_CTX *hash, const char *text)
{
    add(hash, text, strlen(text));
    add(hash, "\n", 1);
}

static void add_number(SHA2_CTX *hash, uint32_t number)
{
    char text[16];
    snprintf(text, sizeof text, "%" PRIu32, number);
    add_line(hash, text);
}

void vdna_comparable_of(const vdna_experience *experience, char out_sha256[VDNA_MAP_SHA256_SIZE])
{
    SHA2_CTX hash;
    SHA256Init(&hash);
    add_line(&hash, "vdna-comparable 1");
    add_line(&hash, experience->model_sha256);
    add_line(&hash, experience->preprocessing);
    add_line(&hash, experience->taps);
    add_number(&hash, experience->dim);
    add_number(&hash, experience->bins);
    add(&hash, experience->range, 2 * sizeof(float) * experience->neurons);

    static const char digits[] = "0123456789abcdef";
    unsigned char digest[SHA256_DIGEST_LENGTH];
    SHA256Final(digest, &hash);
    for (size_t i = 0; i < sizeof digest; i++) {
        out_sha256[2 * i] = digits[digest[i] >> 4];
        out_sha256[2 * i + 1] = digits[digest[i] & 15];
    }
    out_sha256[2 * sizeof digest] = '\0';
}

static vdna_status differ(vdna_error *error, const vdna_experience *a, const vdna_experience *b,
                          const char *field, const char *of_a, const char *of_b)
{
    return vdna_fail(error, VDNA_ERR_MISMATCH,
                     "experiences %s and %s do not compare: %s is %.100s in one and %.100s in the"
                     " other; rebuild one of them with `vdna build`, with the backbone, bins and"
                     " ranges of the other",
                     a->name, b->name, field, of_a, of_b);
}

static vdna_status differ_in_number(vdna_error *error, const vdna_experience *a,
                                    const vdna_experience *b, const char *field, uint32_t of_a,
                                    uint32_t of_b)
{
    char text_a[16], text_b[16];
    snprintf(text_a, sizeof text_a, "%" PRIu32, of_a);
    snprintf(text_b, sizeof text_b, "%" PRIu32, of_b);
    return differ(error, a, b, field, text_a, text_b);
}

static vdna_status compare_models(const vdna_experience *a, const vdna_experience *b,
                                  vdna_error *error)
{
    if (strcmp(a->model_sha256, b->model_sha256) == 0)
        return VDNA_OK;
    /* Where it is the reason that the models differ, it says more than their hashes. */
    const char *of_a = a->precision[0] ? a->precision : VDNA_PRECISION_DEFAULT;
    const char *of_b = b->precision[0] ? b->precision : VDNA_PRECISION_DEFAULT;
    if (strcmp(of_a, of_b) != 0)
        return differ(error, a, b, "precision", of_a, of_b);
    return differ(error, a, b, "model_sha256", a->model_sha256, b->model_sha256);
}

static vdna_status compare_ranges(const vdna_experience *a, const vdna_experience *b,
                                  vdna_error *error)
{
    /* As the histograms compare them: by their bits. */
    for (uint32_t n = 0; n < a->neurons; n++) {
        const float *ra = a->range + 2 * (size_t)n, *rb = b->range + 2 * (size_t)n;
        if (memcmp(ra, rb, 2 * sizeof(float)) == 0)
            continue;
        char field[32], of_a[48], of_b[48];
        snprintf(field, sizeof field, "range of neuron %" PRIu32, n);
        snprintf(of_a, sizeof of_a, "%.9g..%.9g", (double)ra[0], (double)ra[1]);
        snprintf(of_b, sizeof of_b, "%.9g..%.9g", (double)rb[0], (double)rb[1]);
        return differ(error, a, b, field, of_a, of_b);
    }
    return VDNA_OK;
}

/* see vdna/map.h */
vdna_status vdna_experience_compare(const vdna_experience *a, const vdna_experience *b,
                                    vdna_error *error)
{
    if (!a || !b)
        return vdna_fail(error, VDNA_ERR_ARG, "experiences to compare must not be NULL");
    const vdna_status status = compare_models(a, b, error);
    if (status != VDNA_OK)
        return status;
    if (strcmp(a->preprocessing, b->preprocessing) != 0)
        return differ(error, a, b, "preprocessing", a->preprocessing, b->preprocessing);
    if (strcmp(a->taps, b->taps) != 0)
        return differ(error, a, b, "taps", a->taps, b->taps);
    if (a->neurons != b->neurons)
        return differ_in_number(error, a, b, "neurons", a->neurons, b->neurons);
    if (a->dim != b->dim)
        return differ_in_number(error, a, b, "dim", a->dim, b->dim);
    if (a->bins != b->bins)
        return differ_in_number(error, a, b, "bins", a->bins, b->bins);
    return compare_ranges(a, b, error);
}
