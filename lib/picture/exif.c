#include "exif.h"

#include <string.h>

/* A block with the order of its bytes. Offsets are checked before a number is read. */
typedef struct exif_block {
    const uint8_t *bytes;
    size_t size;
    int little;
} exif_block;

static uint32_t u16(const exif_block *block, size_t at)
{
    const uint32_t first = block->bytes[at], second = block->bytes[at + 1];
    return block->little ? first | second << 8 : first << 8 | second;
}

static uint32_t u32(const exif_block *block, size_t at)
{
    const uint32_t first = u16(block, at), second = u16(block, at + 2);
    return block->little ? first | second << 16 : first << 16 | second;
}

/* Where the first directory begins; 0 if it does not lie within the block. */
static size_t directory_of(const exif_block *block)
{
    enum { header = 8, count = 2, entry = 12 };
    if (block->size < header || u16(block, 2) != 42)
        return 0;
    const size_t at = u32(block, 4);
    if (at < header || at > block->size - count)
        return 0;
    return u16(block, at) <= (block->size - count - at) / entry ? at : 0;
}

/* see exif.h */
uint32_t vdna_exif_orientation(const uint8_t *bytes, size_t size)
{
    enum { tag = 0x112, type_short = 3 };
    if (size < 2 || bytes[0] != bytes[1] || (bytes[0] != 'I' && bytes[0] != 'M'))
        return VDNA_UPRIGHT;
    const exif_block block = {bytes, size, bytes[0] == 'I'};
    const size_t directory = directory_of(&block);
    const uint32_t entries = directory ? u16(&block, directory) : 0;
    for (uint32_t i = 0; i < entries; i++) {
        const size_t entry = directory + 2 + (size_t)12 * i;
        if (u16(&block, entry) != tag)
            continue;
        const uint32_t value = u16(&block, entry + 8);
        const int valid = u16(&block, entry + 2) == type_short && u32(&block, entry + 4) == 1 &&
                          value >= 1 && value <= 8;
        return valid ? value : VDNA_UPRIGHT;
    }
    return VDNA_UPRIGHT;
}

/* see exif.h */
uint32_t vdna_jpeg_orientation(const uint8_t *data, size_t size)
{
    enum { app1 = 0xE1, start_of_scan = 0xDA, end_of_image = 0xD9 };
    static const char name[6] = "Exif\0"; /* and one more NUL */
    for (size_t at = 2; size >= 4 && at <= size - 4 && data[at] == 0xFF;) {
        const uint8_t marker = data[at + 1];
        const size_t length = (size_t)data[at + 2] << 8 | data[at + 3], left = size - at - 2;
        if (marker == 0xFF) { /* fills up to the next marker */
            at++;
            continue;
        }
        if (marker == start_of_scan || marker == end_of_image || length < 2 || length > left)
            break;
        if (marker == app1 && length >= 2 + sizeof name &&
            !memcmp(data + at + 4, name, sizeof name))
            return vdna_exif_orientation(data + at + 4 + sizeof name, length - 2 - sizeof name);
        at += 2 + length;
    }
    return VDNA_UPRIGHT;
}
