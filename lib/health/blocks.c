#include "blocks.h"

#include <stddef.h>

#define SAMPLES_X (VDNA_BLOCK_COLUMNS * VDNA_BLOCK_SIDE)
#define SAMPLES_Y (VDNA_BLOCK_ROWS * VDNA_BLOCK_SIDE)

#define SIZE_MOST 65535u /* pixels a side: positions of samples fit 32 bits */
#define BRIGHT 250u

static const uint8_t *row_of(const vdna_pixels *pixels, uint32_t j)
{
    return pixels->data + (2 * j + 1) * pixels->height / (2 * SAMPLES_Y) * pixels->stride;
}

static uint32_t grey_of(const vdna_pixels *pixels, const uint8_t *row, uint32_t i)
{
    const uint32_t x = (2 * i + 1) * pixels->width / (2 * SAMPLES_X);
    const uint8_t *at = row + (size_t)x * pixels->channels;
    const uint32_t *rgb = pixels->rgb;
    return (77u * at[rgb[0]] + 150u * at[rgb[1]] + 29u * at[rgb[2]] + 128u) >> 8;
}

/* see blocks.h */
int vdna_blocks_can_read(const vdna_pixels *pixels)
{
    if (!pixels || !pixels->data || pixels->width < 1 || pixels->width > SIZE_MOST ||
        pixels->height < 1 || pixels->height > SIZE_MOST)
        return 0;
    const uint32_t channels = pixels->channels;
    if (channels != 1 && channels != 3 && channels != 4)
        return 0;
    return pixels->rgb[0] < channels && pixels->rgb[1] < channels && pixels->rgb[2] < channels &&
           pixels->stride >= (size_t)pixels->width * channels;
}

/* see blocks.h */
vdna_block vdna_block_of(const vdna_pixels *pixels, uint32_t block)
{
    const uint32_t left = block % VDNA_BLOCK_COLUMNS * VDNA_BLOCK_SIDE;
    const uint32_t top = block / VDNA_BLOCK_COLUMNS * VDNA_BLOCK_SIDE;
    vdna_block read = {0, 0, 0};
    for (uint32_t j = top; j < top + VDNA_BLOCK_SIDE; j++) {
        const uint8_t *row = row_of(pixels, j);
        for (uint32_t i = left; i < left + VDNA_BLOCK_SIDE; i++) {
            const uint32_t grey = grey_of(pixels, row, i);
            read.sum += grey;
            read.squares += grey * grey;
            read.bright += grey >= BRIGHT;
        }
    }
    return read;
}
