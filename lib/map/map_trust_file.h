/* Private to lib/map: the file of what a map knows about itself, for its writer and its reader
 * alike. */
#ifndef VDNA_MAP_TRUST_FILE_H
#define VDNA_MAP_TRUST_FILE_H

#include <vdna/map_trust.h>

#include "tensors.h"

/* The order of the tensors: wide elements first, so that each is aligned. */
enum {
    VDNA_TRUST_FIELD_TOLERANCE,
    VDNA_TRUST_FIELD_OWN_SCALE,
    VDNA_TRUST_FIELD_CORRELATION,
    VDNA_TRUST_FIELD_CELLS,
    VDNA_TRUST_FIELD_FRAMES,
    VDNA_TRUST_FIELD_MEMBER_CRC,
    VDNA_TRUST_FIELD_MEMBER_NAME,
    VDNA_TRUST_FIELD_COUNT
};

/* Contents of a file, borrowed. */
typedef struct vdna_map_trust_file {
    char comparable[VDNA_SHA256_SIZE]; /* of every member */
    uint32_t localiser;                /* VDNA_TRUST_CENTRED or _EUCLIDEAN */
    uint32_t members;                  /* 1..VDNA_TRUST_RUNS_MAX */
    const double *tolerance;           /* [1] */
    const char *names;                 /* [members][VDNA_NAME_SIZE], padded with NULs; each once */
    const uint32_t *checksums;         /* [members], of their files */
    vdna_trust_tables tables;          /* of the members */
} vdna_map_trust_file;

/* Name of a member. */
static inline const char *vdna_map_trust_name(const vdna_map_trust_file *file, uint32_t member)
{
    return file->names + (size_t)member * VDNA_NAME_SIZE;
}

extern const vdna_format vdna_map_trust_format;

/* Words for the localisers, by number. */
extern const char *const vdna_map_trust_localisers[2];

/* Describe the tensors: shapes from `members`, data from the pointers. */
void vdna_map_trust_layout_of(const vdna_map_trust_file *file,
                              vdna_field out_fields[VDNA_TRUST_FIELD_COUNT]);

/* Check contents against the rules of docs/reference/SPEC-map.md. Their pointers are not NULL.
 * @param reason  filled on failure, without the name of the file
 * @return VDNA_OK; VDNA_ERR_ARG; VDNA_ERR_NONFINITE; VDNA_ERR_MISMATCH */
vdna_status vdna_map_trust_check(const vdna_map_trust_file *file, vdna_error *reason);

/* Check every byte of a file and point into it.
 * @param bytes  aligned for double
 * @param reason  filled on failure, without the name of the file
 * @return VDNA_OK; VDNA_ERR_FORMAT; VDNA_ERR_CHECKSUM; VDNA_ERR_UNSUPPORTED */
vdna_status vdna_map_trust_read(const unsigned char *bytes, size_t size, vdna_error *reason,
                                vdna_map_trust_file *out_file);

/* The path of a map's file.
 * @return VDNA_OK; VDNA_ERR_IO if it is too long */
vdna_status vdna_map_trust_path(const char *directory, vdna_error *error,
                                char out_path[VDNA_REPLACE_PATH_SIZE]);

#endif
