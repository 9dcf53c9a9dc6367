#include <string.h>

#include <vdna/identity.h>

/* see vdna/identity.h */
vdna_status vdna_identity_project(const vdna_identity *identity, const float *embedding,
                                  float *out_embedding)
{
    if (!identity || !embedding || !out_embedding)
        return VDNA_ERR_ARG;
    if (!identity->projection) {
        memcpy(out_embedding, embedding, sizeof(float) * identity->dim);
        return VDNA_OK;
    }
    for (size_t d = 0; d < identity->dim; d++) {
        const float *const direction = identity->projection + d * identity->raw_dim;
        double sum = 0;
        for (size_t i = 0; i < identity->raw_dim; i++)
            sum += (double)direction[i] * (double)embedding[i];
        out_embedding[d] = (float)sum;
    }
    return VDNA_OK;
}
