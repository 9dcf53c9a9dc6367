#include <string.h>

#include <vdna/health.h>

#include "blocks.h"

#define COLUMNS VDNA_BLOCK_COLUMNS
#define ROWS VDNA_BLOCK_ROWS
#define BLOCKS VDNA_BLOCKS
#define SAMPLES VDNA_BLOCK_SAMPLES
#define PAIRS ((COLUMNS - 1) * ROWS + COLUMNS * (ROWS - 1))

#define EXTREME 4u /* blocks beyond a level that counts as reached */

/* Words of 64 bits that are hashed side by side: a product takes as long as four may begin in. */
#define LANES 4u
#define STRIPE ((size_t)8 * LANES)

/* Odd, and half of its bits set: the golden ratio of 64 bits. */
#define MULTIPLIER UINT64_C(0x9E3779B97F4A7C15)

/* The level and deviation of each block, and what is counted over all samples. */
typedef struct block_table {
    uint8_t levels[BLOCKS];
    uint8_t deviations[BLOCKS];
    uint32_t bright;
} block_table;

static uint32_t root_of(uint32_t square)
{
    uint32_t root = 0;
    for (uint32_t bit = 1u << 15; bit > 0; bit >>= 1)
        if ((root + bit) * (root + bit) <= square)
            root += bit;
    return root;
}

/* A product moves differences upwards only, so its upper half is brought down again. */
static uint64_t mix(uint64_t hash, uint64_t word)
{
    hash = (hash ^ word) * MULTIPLIER;
    return hash ^ hash >> 32;
}

/* Little-endian on every machine; compilers make one load of it. */
static uint64_t word_at(const uint8_t *b)
{
    return b[0] | (uint64_t)b[1] << 8 | (uint64_t)b[2] << 16 | (uint64_t)b[3] << 24 |
           (uint64_t)b[4] << 32 | (uint64_t)b[5] << 40 | (uint64_t)b[6] << 48 |
           (uint64_t)b[7] << 56;
}

static void hash_stripe(uint64_t *lanes, const uint8_t *bytes)
{
    for (unsigned i = 0; i < LANES; i++)
        lanes[i] = mix(lanes[i], word_at(bytes + (size_t)8 * i));
}

static void hash_row(uint64_t *lanes, const uint8_t *row, size_t bytes)
{
    for (; bytes >= STRIPE; bytes -= STRIPE, row += STRIPE)
        hash_stripe(lanes, row);
    uint8_t rest[STRIPE] = {0};
    memcpy(rest, row, bytes);
    hash_stripe(lanes, rest);
}

static uint64_t hash_of(const vdna_pixels *pixels)
{
    uint64_t lanes[LANES] = {1, 2, 3, 4};
    for (uint32_t y = 0; y < pixels->height; y++)
        hash_row(lanes, pixels->data + y * pixels->stride,
                 (size_t)pixels->width * pixels->channels);
    uint64_t hash = (uint64_t)pixels->width << 32 | pixels->height;
    for (unsigned i = 0; i < LANES; i++)
        hash = mix(hash, lanes[i]);
    return mix(hash, 0);
}

static void read_block(const vdna_pixels *pixels, uint32_t block, block_table *table)
{
    const vdna_block read = vdna_block_of(pixels, block);
    table->levels[block] = (uint8_t)((read.sum + SAMPLES / 2) / SAMPLES);
    table->deviations[block] =
        (uint8_t)root_of((SAMPLES * read.squares - read.sum * read.sum) / (SAMPLES * SAMPLES));
    table->bright += read.bright;
}

/* The `rank`th smallest of the blocks' values, from 1. */
static uint32_t level_of_rank(const uint8_t *values, uint32_t rank)
{
    uint8_t counts[256] = {0};
    for (uint32_t i = 0; i < BLOCKS; i++)
        counts[values[i]]++;
    uint32_t value = 0, below = counts[0];
    while (below < rank)
        below += counts[++value];
    return value;
}

static uint32_t sum_of(const uint8_t *levels)
{
    uint32_t sum = 0;
    for (uint32_t i = 0; i < BLOCKS; i++)
        sum += levels[i];
    return sum;
}

/* Covariance of neighbouring blocks about the mean of all. Levels count BLOCKS times here, so that
 * the mean is a whole number. */
static uint32_t structure_of(const uint8_t *levels, uint32_t sum)
{
    int64_t covariance = 0;
    /* NOLINTBEGIN(bugprone-implicit-widening-of-multiplication-result): small constants */
    for (uint32_t i = 0; i < BLOCKS; i++) {
        const int64_t here = (int64_t)levels[i] * BLOCKS - sum;
        if (i % COLUMNS > 0)
            covariance += here * ((int64_t)levels[i - 1] * BLOCKS - sum);
        if (i >= COLUMNS)
            covariance += here * ((int64_t)levels[i - COLUMNS] * BLOCKS - sum);
    }
    if (covariance < 0)
        return 0;
    return root_of((uint32_t)(covariance / ((int64_t)PAIRS * BLOCKS * BLOCKS)));
    /* NOLINTEND(bugprone-implicit-widening-of-multiplication-result) */
}

/* see vdna/health.h */
vdna_status vdna_health_measure(const vdna_pixels *pixels, vdna_health_picture *out_picture)
{
    if (!vdna_blocks_can_read(pixels) || !out_picture)
        return VDNA_ERR_ARG;

    block_table table;
    table.bright = 0;
    for (uint32_t block = 0; block < BLOCKS; block++)
        read_block(pixels, block, &table);

    const uint32_t sum = sum_of(table.levels);
    out_picture->hash = hash_of(pixels);
    out_picture->width = pixels->width;
    out_picture->height = pixels->height;
    out_picture->mean = sum / BLOCKS;
    out_picture->contrast =
        level_of_rank(table.levels, BLOCKS + 1 - EXTREME) - level_of_rank(table.levels, EXTREME);
    out_picture->structure = structure_of(table.levels, sum);
    const uint32_t grain = level_of_rank(table.deviations, BLOCKS / 2);
    out_picture->grain = grain > 0 ? grain : 1;
    out_picture->bright = 1000 * table.bright / (BLOCKS * SAMPLES);
    out_picture->reserved = 0;
    return VDNA_OK;
}
