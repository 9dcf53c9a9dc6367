/* Private to lib/map: the header of a safetensors file, independent of the purpose of its
 * tensors. */
#ifndef VDNA_HEADER_H
#define VDNA_HEADER_H

#include <vdna/map.h>

/* Limits of a map's files, so that a header fits a block of known size
 * (docs/reference/SPEC-map.md). */
#define VDNA_HEADER_TENSORS 32u
#define VDNA_HEADER_TEXTS 32u
#define VDNA_HEADER_KEY_SIZE 64u
#define VDNA_HEADER_DIMENSIONS 8u

typedef struct vdna_tensor {
    char name[VDNA_HEADER_KEY_SIZE];
    char dtype[VDNA_HEADER_KEY_SIZE];
    uint64_t shape[VDNA_HEADER_DIMENSIONS];
    uint32_t dimensions;
    uint64_t begin, end; /* bytes, from the first byte of the file */
} vdna_tensor;

typedef struct vdna_metadata {
    char key[VDNA_HEADER_KEY_SIZE];
    char value[VDNA_TAPS_SIZE]; /* of the longest text that is read */
} vdna_metadata;

typedef struct vdna_header {
    vdna_tensor tensors[VDNA_HEADER_TENSORS]; /* in the order of their bytes */
    vdna_metadata texts[VDNA_HEADER_TEXTS];
    uint32_t tensor_count, text_count;
    int has_metadata;
} vdna_header;

/* Read the header of a whole file and check that its tensors fill the rest of the file without a
 * gap or an overlap. The caller, who knows the tensors, checks dtypes and shapes.
 * @param reason  filled on failure, without the name of the file
 * @return VDNA_OK; VDNA_ERR_FORMAT */
vdna_status vdna_header_read(const unsigned char *bytes, size_t size, vdna_error *reason,
                             vdna_header *out_header);

/* @return NULL if there is no such tensor */
const vdna_tensor *vdna_header_tensor(const vdna_header *header, const char *name);

/* @return NULL if there is no such text in __metadata__ */
const char *vdna_header_text(const vdna_header *header, const char *key);

#endif
