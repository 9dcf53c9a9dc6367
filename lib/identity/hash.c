#include <inttypes.h>
#include <sha2.h>
#include <stdio.h>
#include <string.h>

#include <vdna/identity.h>

static int version_of(const vdna_identity *identity)
{
    if (identity->projection)
        return 3;
    return identity->embedding[0] != '\0' ? 2 : 1;
}

/* see vdna/identity.h */
vdna_status vdna_identity_text(const vdna_identity *identity,
                               char out_text[VDNA_IDENTITY_TEXT_SIZE])
{
    if (!identity || !out_text)
        return VDNA_ERR_ARG;
    /* No text can contain the newline that ends its line. Without a projection and a definition of
     * the embedding it is the text of version 2 or 1, so that old files keep their hash. */
    const int version = version_of(identity);
    const int length =
        snprintf(out_text, VDNA_IDENTITY_TEXT_SIZE,
                 "vdna-comparable %d\n%.64s\n%.511s\n%.2047s\n%" PRIu32 "\n%" PRIu32 "\n%.255s%s",
                 version, identity->model_sha256, identity->preprocessing, identity->taps,
                 identity->dim, identity->bins, identity->embedding, version > 1 ? "\n" : "");
    if (version > 2)
        snprintf(out_text + length, VDNA_IDENTITY_TEXT_SIZE - (size_t)length, "%" PRIu32 "\n",
                 identity->raw_dim);
    return VDNA_OK;
}

static void write_hex(const unsigned char digest[SHA256_DIGEST_LENGTH],
                      char out_sha256[VDNA_SHA256_SIZE])
{
    static const char digits[] = "0123456789abcdef";
    for (size_t i = 0; i < SHA256_DIGEST_LENGTH; i++) {
        out_sha256[2 * i] = digits[digest[i] >> 4];
        out_sha256[2 * i + 1] = digits[digest[i] & 15];
    }
    out_sha256[VDNA_SHA256_SIZE - 1] = '\0';
}

/* see vdna/identity.h */
vdna_status vdna_identity_hash(const vdna_identity *identity, char out_sha256[VDNA_SHA256_SIZE])
{
    char text[VDNA_IDENTITY_TEXT_SIZE];
    if (!out_sha256 || vdna_identity_text(identity, text) != VDNA_OK || identity->dim == 0 ||
        identity->bins == 0 || !identity->range)
        return VDNA_ERR_ARG;

    SHA2_CTX hash;
    unsigned char digest[SHA256_DIGEST_LENGTH];
    SHA256Init(&hash);
    SHA256Update(&hash, (const uint8_t *)text, strlen(text));
    SHA256Update(&hash, (const uint8_t *)identity->range,
                 2 * sizeof(float) * (size_t)identity->neurons);
    if (identity->projection)
        SHA256Update(&hash, (const uint8_t *)identity->projection,
                     sizeof(float) * identity->dim * identity->raw_dim);
    SHA256Final(digest, &hash);
    write_hex(digest, out_sha256);
    return VDNA_OK;
}
