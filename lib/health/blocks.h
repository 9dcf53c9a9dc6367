/* The blocks of samples that pictures are measured by: see vdna_health_picture. Private. */
#ifndef VDNA_HEALTH_BLOCKS_H
#define VDNA_HEALTH_BLOCKS_H

#include <vdna/pixels.h>

#define VDNA_BLOCK_COLUMNS 16u
#define VDNA_BLOCK_ROWS 12u
#define VDNA_BLOCKS (VDNA_BLOCK_COLUMNS * VDNA_BLOCK_ROWS)
#define VDNA_BLOCK_SIDE 10u /* samples, in each direction */
#define VDNA_BLOCK_SAMPLES (VDNA_BLOCK_SIDE * VDNA_BLOCK_SIDE)

/* Sums over the grey levels of a block's samples. */
typedef struct vdna_block {
    uint32_t sum;
    uint32_t squares;
    uint32_t bright; /* samples of level 250 or more */
} vdna_block;

/* 1 if there are pixels to read, with sides of 1..65535. */
int vdna_blocks_can_read(const vdna_pixels *pixels);

/* Read block 0..VDNA_BLOCKS - 1, row by row, of such pixels. */
vdna_block vdna_block_of(const vdna_pixels *pixels, uint32_t block);

#endif
