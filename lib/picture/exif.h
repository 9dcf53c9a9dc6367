/* The orientation that a picture file states about itself. */
#ifndef VDNA_EXIF_H
#define VDNA_EXIF_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The orientation of a picture as it is stored: nothing to turn. */
#define VDNA_UPRIGHT 1u

/* Orientation in an EXIF block, which is laid out as a TIFF file, and so in a TIFF file itself:
 * 1..8, as vdna_turn_of() takes it. A damaged block states none, which is VDNA_UPRIGHT. */
uint32_t vdna_exif_orientation(const uint8_t *block, size_t size);

/* The same of a JPEG picture: its first segment APP1 that holds EXIF counts. */
uint32_t vdna_jpeg_orientation(const uint8_t *data, size_t size);

#ifdef __cplusplus
}
#endif

#endif
