/* Pixels of any shape: they are measured within what their fields say, or refused. Any measures, as
 * another process may send them, are judged, and counts add up. No picture is
 * parked when it comes again.
 *
 * The first 8 bytes are the shape (width, height, padding, channels, order of colours, offset);
 * the rest are the bytes of the pixels, repeated as often as needed. */
#include <string.h>

#include <vdna/health.h>
#include <vdna/parked.h>

#include "fuzz.h"

/* Sides are below SIDES, so that millions of pictures can be tried. */
enum { HEAD = 8, SIDES = 80 };

size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity)
{
    static const uint8_t heads[][HEAD] = {{79, 60, 0, 1, 0, 0, 0, 0},
                                          {32, 32, 5, 3, 0, 1, 2, 0},
                                          {1, 78, 1, 4, 2, 1, 0, 0},
                                          {7, 3, 0, 2, 0, 0, 0, 0}};
    enum { BYTES = 64 };
    if (index >= sizeof heads / sizeof *heads || capacity < HEAD + BYTES)
        return 0;
    memcpy(out, heads[index], HEAD);
    for (size_t i = 0; i < BYTES; i++)
        out[HEAD + i] = (uint8_t)(i * index * 37);
    return HEAD + BYTES;
}

/* A block of its exact size, so that sanitizers see the first byte beyond it. */
static uint8_t *repeated(const uint8_t *bytes, size_t count, size_t size)
{
    uint8_t *block = malloc(size > 0 ? size : 1);
    if (!block)
        abort();
    for (size_t i = 0; i < size; i++)
        block[i] = bytes[i % count];
    return block;
}

static void check_picture(const vdna_health_picture *p)
{
    MUST(p->mean <= 255 && p->contrast <= 255 && p->structure <= 127 && p->grain >= 1 &&
         p->grain <= 127 && p->bright <= 1000);
}

static void measure(vdna_health *health, const uint8_t *bytes, size_t size)
{
    const uint32_t width = bytes[0] % SIDES, height = bytes[1] % SIDES, channels = bytes[3];
    const size_t stride = (size_t)width * channels + bytes[2];
    const size_t block_size = height > 0 ? (height - 1) * stride + (size_t)width * channels : 0;
    uint8_t *block = repeated(bytes + HEAD, size - HEAD, block_size);
    const vdna_pixels pixels = {block,  stride,   width,
                                height, channels, {bytes[4], bytes[5], bytes[6]}};
    vdna_health_picture picture, again;
    if (vdna_health_measure(&pixels, &picture) == VDNA_OK) {
        check_picture(&picture);
        MUST(vdna_health_measure(&pixels, &again) == VDNA_OK);
        MUST(memcmp(&picture, &again, sizeof picture) == 0);
        const uint32_t first = vdna_health_take(health, &picture);
        MUST(vdna_health_take(health, &again) != VDNA_HEALTH_OK || first != VDNA_HEALTH_OK);
    }
    vdna_parked_picture levels;
    if (vdna_parked_measure(&pixels, &levels) == VDNA_OK)
        for (uint32_t i = 0; i < VDNA_PARKED_BLOCKS; i++)
            MUST(levels.levels[i] <= 25500);
    free(block);
}

/* Any levels, as another process may send them. */
static void look_at_any(const uint8_t *bytes, size_t size)
{
    vdna_parked parked;
    vdna_parked_picture picture;
    MUST(vdna_parked_init(&parked, bytes[0]) == VDNA_OK);
    MUST(vdna_parked_init(&parked, VDNA_PARKED_LIMIT_MAX + 1 + bytes[0]) == VDNA_ERR_ARG);
    for (size_t at = 0; at + HEAD <= size; at += HEAD) {
        for (size_t i = 0; i < VDNA_PARKED_BLOCKS; i++)
            picture.levels[i] = (uint16_t)(bytes[at + i % HEAD] << bytes[at] % 9);
        const uint32_t is_parked = vdna_parked_look(&parked, &picture);
        MUST(!is_parked || (parked.has_reference && parked.noise > 0));
        if (bytes[at] % 16 != 0)
            vdna_parked_keep(&parked);
        MUST(vdna_parked_look(&parked, &picture) == 0);
    }
}

static void take_any(vdna_health *health, const uint8_t *bytes, size_t size)
{
    vdna_health_picture picture;
    for (; size >= sizeof picture; bytes += sizeof picture, size -= sizeof picture) {
        memcpy(&picture, bytes, sizeof picture);
        const uint32_t alone = vdna_health_judge(health, &picture);
        const uint32_t verdict = vdna_health_take(health, &picture);
        MUST(verdict == alone || (alone == VDNA_HEALTH_OK && verdict > VDNA_HEALTH_NOISE));
        MUST(verdict < VDNA_HEALTH_COUNT && vdna_health_text(verdict)[0] != '\0');
        MUST(vdna_health_degraded(health) < VDNA_HEALTH_COUNT);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    if (size <= HEAD)
        return 0;
    vdna_health health;
    MUST(vdna_health_init(&health, NULL) == VDNA_OK);
    measure(&health, bytes, size);
    take_any(&health, bytes, size);
    look_at_any(bytes, size);
    uint64_t frames = 0;
    for (size_t i = 0; i < VDNA_HEALTH_COUNT; i++)
        frames += health.counts[i];
    MUST(frames == health.frames);

    /* The first bytes are a configuration as well, of a size that is accepted if the first is odd.
     */
    vdna_health_config config;
    vdna_health_config_init(&config);
    MUST(vdna_health_init(&health, &config) == VDNA_OK);
    if (size >= sizeof config) {
        memcpy(&config, bytes, sizeof config);
        if (bytes[0] % 2)
            config.struct_size = sizeof config;
        if (vdna_health_init(&health, &config) == VDNA_OK)
            take_any(&health, bytes, size);
    }
    return 0;
}
