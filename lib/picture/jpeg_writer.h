/* Write JPEG pictures with libjpeg. */
#ifndef VDNA_JPEG_WRITER_H
#define VDNA_JPEG_WRITER_H

#include <stddef.h>
#include <stdint.h>

#include <vdna/pixels.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Encode a picture.
 * quality: libjpeg's, 1..100
 * small: 1 = tables made for this picture, which shortens it by some hundred bytes and takes a
 *        second pass over it; 0 = the usual ones
 * out_data: the caller's, to be freed with free(); untouched on failure
 * Returns 1, or 0 if memory is short or the channels are not grey, RGB or BGR. */
int vdna_jpeg_write(const vdna_pixels *pixels, int quality, int small, uint8_t **out_data,
                    size_t *out_size);

#ifdef __cplusplus
}
#endif

#endif
