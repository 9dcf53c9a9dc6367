/* Turning a picture upright while its rows arrive: no second picture is needed, and one that is
 * upright costs nothing. */
#ifndef VDNA_TURN_H
#define VDNA_TURN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Bytes of a pixel: blue, green, red. */
#define VDNA_TURN_CHANNELS 3

/* Where the pixels of a stored picture go in the upright one, whose rows are packed. */
typedef struct vdna_turn {
    uint32_t width, height; /* pixels, of the upright picture */
    size_t first;           /* bytes from its beginning to the first stored pixel */
    ptrdiff_t pixel_step;   /* bytes from a stored pixel to the next one of its row */
    ptrdiff_t row_step;     /* bytes from a stored row's first pixel to that of the next row */
} vdna_turn;

/* orientation: as in EXIF, 1..8; width, height: of the stored picture, at least 1 */
vdna_turn vdna_turn_of(uint32_t orientation, uint32_t width, uint32_t height);

/* 1 if the stored rows are rows of the upright picture, so that they can be written in place. */
int vdna_turn_keeps_rows(const vdna_turn *turn);

/* Where the first pixel of stored row `y` goes. */
uint8_t *vdna_turn_begin(const vdna_turn *turn, uint8_t *out, size_t y);

/* Write stored row `y`, of `width` pixels. */
void vdna_turn_row(const vdna_turn *turn, const uint8_t *row, size_t width, size_t y, uint8_t *out);

#ifdef __cplusplus
}
#endif

#endif
