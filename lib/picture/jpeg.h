/* Decode JPEG pictures completely or refuse them: left to itself, libjpeg fills the hole in a
 * damaged one with grey and tells only stderr. */
#ifndef VDNA_JPEG_H
#define VDNA_JPEG_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Room for libjpeg's reason to refuse a picture. */
#define VDNA_JPEG_REASON_MAX 200

/* Does a JPEG picture begin here? 1 or 0. */
int vdna_jpeg_begins(const uint8_t *data, size_t size);

/* Read width and height, in pixels. Returns 1, or 0 with `reason` filled. */
int vdna_jpeg_size(const uint8_t *data, size_t size, uint32_t *out_width, uint32_t *out_height,
                   char *reason);

/* Decode into `out_bgr`, rows of `stride` bytes, sized by vdna_jpeg_size() of the same bytes.
 * An orientation in EXIF is not applied. Returns 1, or 0 with `reason` filled. */
int vdna_jpeg_decode(const uint8_t *data, size_t size, uint8_t *out_bgr, size_t stride,
                     char *reason);

#ifdef __cplusplus
}
#endif

#endif
