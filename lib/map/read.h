/* Private to lib/map: reads an experience from the bytes of its file. */
#ifndef VDNA_READ_H
#define VDNA_READ_H

#include <vdna/map.h>

/* What becomes of embeddings that are stored as codes. */
typedef enum vdna_read_how {
    VDNA_READ_DECODED, /* `embeddings` are decoded into memory of the experience */
    VDNA_READ_IN_PLACE /* `embeddings` are NULL; nothing is allocated */
} vdna_read_how;

/* Check every byte of a file and point into it, but for embeddings to be decoded.
 * @param bytes  aligned for int64_t; borrowed by `out_experience`, whose file_bytes stays NULL
 * @param reason  filled on failure, without the name of the file
 * @param out_experience  to be ended with vdna_read_free()
 * @return VDNA_OK; VDNA_ERR_FORMAT; VDNA_ERR_CHECKSUM; VDNA_ERR_UNSUPPORTED; VDNA_ERR_NOMEM */
vdna_status vdna_read(const unsigned char *bytes, size_t size, vdna_read_how how,
                      vdna_error *reason, vdna_experience *out_experience);

/* Read what the header of a file says, the texts and the sizes, and check it by itself. No tensor
 * is read and no pointer set.
 * @param size  of the whole file
 * @param reason  filled on failure, without the name of the file
 * @return VDNA_OK; VDNA_ERR_FORMAT; VDNA_ERR_UNSUPPORTED */
vdna_status vdna_read_header(const unsigned char *bytes, size_t size, vdna_error *reason,
                             vdna_experience *out_experience);

/* What to do about a file that vdna_read() refused, for the end of an error. */
const char *vdna_read_remedy(vdna_status status);

/* Free the embeddings that were decoded, if any. */
void vdna_read_free(const vdna_experience *experience);

#endif
