#include <string.h>

#include <vdna/parked.h>

#include "blocks.h"

#define HALF (VDNA_PARKED_WINDOW / 2)

/* Pictures of a standing view differ by noise alone, near or far in time; its estimate from a
 * window is good to a few percent. */
#define DISTANT_PER_NEIGHBOUR_X2 3u /* 1.5 */
#define PARKED_PER_NOISE_X4 9u      /* 1.5, squared */

/* see vdna/parked.h */
vdna_status vdna_parked_measure(const vdna_pixels *pixels, vdna_parked_picture *out_picture)
{
    if (!vdna_blocks_can_read(pixels) || !out_picture)
        return VDNA_ERR_ARG;
    for (uint32_t i = 0; i < VDNA_PARKED_BLOCKS; i++)
        out_picture->levels[i] = (uint16_t)vdna_block_of(pixels, i).sum;
    return VDNA_OK;
}

/* see vdna/parked.h */
vdna_status vdna_parked_init(vdna_parked *parked, uint32_t limit)
{
    if (!parked || limit > VDNA_PARKED_LIMIT_MAX)
        return VDNA_ERR_ARG;
    memset(parked, 0, sizeof *parked);
    parked->limit = (uint64_t)limit * limit * VDNA_PARKED_BLOCKS;
    return VDNA_OK;
}

static uint64_t difference_of(const vdna_parked_picture *a, const vdna_parked_picture *b)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < VDNA_PARKED_BLOCKS; i++) {
        const int64_t difference = (int64_t)a->levels[i] - b->levels[i];
        sum += (uint64_t)(difference * difference);
    }
    return sum;
}

/* FNV-1a over the levels. */
static uint64_t hash_of_levels(const vdna_parked_picture *picture)
{
    uint64_t hash = UINT64_C(0xCBF29CE484222325);
    for (uint32_t i = 0; i < VDNA_PARKED_BLOCKS; i++)
        hash = (hash ^ picture->levels[i]) * UINT64_C(0x100000001B3);
    return hash;
}

/* Whether the picture was among the newest looks; it is from now on. */
static int is_repeated(vdna_parked *parked, const vdna_parked_picture *picture)
{
    const uint64_t hash = hash_of_levels(picture);
    int found = 0;
    for (uint32_t i = 0; i < VDNA_PARKED_REMEMBERED && i < parked->looks; i++)
        found |= parked->hashes[i] == hash;
    parked->hashes[parked->looks % VDNA_PARKED_REMEMBERED] = hash;
    return found;
}

/* Of a whole window: the noise, if the view stood. */
static void judge_window(vdna_parked *parked)
{
    const uint64_t neighbour = parked->neighbours / (VDNA_PARKED_WINDOW - 1);
    const uint64_t distant = parked->distant / HALF;
    if (2 * distant <= DISTANT_PER_NEIGHBOUR_X2 * neighbour)
        parked->noise = neighbour;
    parked->window = 0;
}

static void measure_noise(vdna_parked *parked, const vdna_parked_picture *picture)
{
    if (parked->window == 0) {
        parked->first = *picture;
        parked->neighbours = parked->distant = 0;
    } else {
        parked->neighbours += difference_of(&parked->newest, picture);
        if (parked->window >= HALF)
            parked->distant += difference_of(&parked->first, picture);
    }
    if (++parked->window == VDNA_PARKED_WINDOW)
        judge_window(parked);
}

/* see vdna/parked.h */
uint32_t vdna_parked_look(vdna_parked *parked, const vdna_parked_picture *picture)
{
    const int repeated = is_repeated(parked, picture);
    if (!repeated)
        measure_noise(parked, picture);
    parked->newest = *picture;
    parked->looks++;
    if (repeated || !parked->has_reference || parked->noise == 0)
        return 0;
    const uint64_t difference = difference_of(&parked->reference, picture);
    return difference <= parked->limit && 4 * difference <= PARKED_PER_NOISE_X4 * parked->noise;
}

/* see vdna/parked.h */
void vdna_parked_keep(vdna_parked *parked)
{
    parked->reference = parked->newest;
    parked->has_reference = 1;
}
