/** @file vdna/pixels.h
 *  @brief Pixels of a decoded picture: plain struct, no code.
 */
#ifndef VDNA_PIXELS_H
#define VDNA_PIXELS_H

#include <stddef.h>
#include <stdint.h>

/** Pixels of a decoded picture, 8 bits a channel, top row first. Whoever fills the struct says how
 *  long `data` is borrowed. */
typedef struct vdna_pixels {
    const uint8_t *data; /**< first byte of the top row; borrowed */
    size_t stride;       /**< bytes from row to row, >= width * channels */
    uint32_t width;      /**< pixels, >= 1 */
    uint32_t height;     /**< pixels, >= 1 */
    uint32_t channels;   /**< bytes of a pixel: 1 (grey), 3 or 4 */
    uint32_t rgb[3];     /**< which byte of a pixel is red, green, blue; all 0 for grey */
} vdna_pixels;

#endif
