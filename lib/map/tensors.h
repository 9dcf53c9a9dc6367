/* Private to lib/map: the files of a map, whatever they are of: the safetensors layout with a
 * format and its version in the metadata, tensors of known shapes, and a checksum of everything
 * (docs/reference/SPEC-map.md). */
#ifndef VDNA_TENSORS_H
#define VDNA_TENSORS_H

#include "header.h"
#include "replace/replace.h"

/* The last tensor: a checksum of everything else. */
#define VDNA_CRC_TENSOR "crc32c"

#define VDNA_FIELD_DIMENSIONS 4u

/* A tensor. */
typedef struct vdna_field {
    const char *name;
    const char *dtype;
    uint32_t width; /* bytes of an element, and its alignment; the checksum alone needs none */
    int optional;
    uint32_t shape[VDNA_FIELD_DIMENSIONS]; /* ends before the first 0 */
    const void *data;                      /* NULL = absent */
} vdna_field;

/* A string of the metadata, of printable ASCII. */
typedef struct vdna_text {
    const char *key;
    const char *value; /* NULL = absent */
} vdna_text;

/* What a file is of. */
typedef struct vdna_format {
    const char *name;
    unsigned version; /* newest, 1 to 9 */
} vdna_format;

/* Elements of a field, whose product must fit. */
uint64_t vdna_field_elements(const vdna_field *field);

/* Whether a file's numbers can be used in place: this machine is little-endian. */
int vdna_tensors_fit_host(void);

/* Read the header of a file, and check its format and its version. Only the header's bytes are
 * read.
 * @param size  of the whole file
 * @param reason  filled on failure, without the name of the file
 * @return VDNA_OK; VDNA_ERR_FORMAT; VDNA_ERR_UNSUPPORTED for a newer version or a big-endian
 *         machine */
vdna_status vdna_tensors_header(const unsigned char *bytes, size_t size, const vdna_format *format,
                                vdna_error *reason, vdna_header *out_header);

/* The same, and check the checksum of the whole file.
 * @return what vdna_tensors_header() returns; VDNA_ERR_CHECKSUM */
vdna_status vdna_tensors_read(const unsigned char *bytes, size_t size, const vdna_format *format,
                              vdna_error *reason, vdna_header *out_header, uint32_t *out_checksum);

/* Copy a string of the metadata. @return VDNA_OK; VDNA_ERR_FORMAT if it is missing or too long */
vdna_status vdna_tensors_text(const vdna_header *header, const char *key, char *out,
                              size_t capacity, vdna_error *reason);

/* Find the fields among the tensors, check dtype, shape and alignment, and point into the file.
 * Fields that are not there keep their `data`.
 * @param bytes  aligned for the widest field
 * @return VDNA_OK; VDNA_ERR_FORMAT */
vdna_status vdna_tensors_find(const unsigned char *bytes, const vdna_header *header,
                              vdna_field *fields, size_t count, vdna_error *reason);

/* The value that tensor `crc` (U32 [1]) must have: the checksum of all other bytes of the file. */
uint32_t vdna_tensors_checksum(const unsigned char *bytes, size_t size, const vdna_tensor *crc);

/* Write a file: header, the fields that have data, checksum.
 * @param fields  wide elements first, so that each is aligned
 * @return VDNA_OK; VDNA_ERR_IO, and `file` has been abandoned */
vdna_status vdna_tensors_write(vdna_replace *file, const vdna_text *texts, size_t text_count,
                               const vdna_field *fields, size_t field_count, vdna_error *error);

#endif
