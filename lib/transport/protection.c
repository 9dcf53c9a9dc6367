#include "protection.h"

#include <crc32c.h>

#include "cursor.h"

#define VERSION 1
/* Bytes of the value that the checksum covers: version, stream, sequence. */
#define COVERED_BYTES (VDNA_PROTECTION_BYTES - sizeof(uint32_t))
/* Bytes of a camera message: its fingerprint, and what is between that and the picture. */
#define FINGERPRINT_BYTES sizeof(uint64_t)
#define FIELD_BYTES (sizeof(int64_t) + 5 * sizeof(int32_t))

static void write_unsigned(uint8_t *bytes, uint64_t value, size_t size)
{
    for (size_t i = 0; i < size; i++)
        bytes[i] = (uint8_t)(value >> 8 * (size - 1 - i));
}

static uint32_t checksum(const uint8_t *message, size_t picture_bytes, const uint8_t *value)
{
    const uint32_t picture =
        vdna_crc32c(0, message + FINGERPRINT_BYTES, FIELD_BYTES + picture_bytes);
    return vdna_crc32c(picture, value, COVERED_BYTES);
}

/* see protection.h */
void vdna_protection_begin(const vdna_transport_stream *stream,
                           uint8_t out_value[VDNA_PROTECTION_BYTES])
{
    out_value[0] = VERSION;
    write_unsigned(out_value + 1, stream->id, sizeof stream->id);
    write_unsigned(out_value + 9, stream->sequence, sizeof stream->sequence);
    write_unsigned(out_value + COVERED_BYTES, 0, sizeof(uint32_t));
}

/* see protection.h */
void vdna_protection_finish(uint8_t *message, size_t message_bytes, size_t picture_bytes)
{
    uint8_t *value = message + message_bytes - VDNA_PROTECTION_BYTES;
    write_unsigned(value + COVERED_BYTES, checksum(message, picture_bytes, value),
                   sizeof(uint32_t));
}

static vdna_protection read_value(const uint8_t *message, size_t picture_bytes,
                                  const uint8_t *value, size_t size)
{
    vdna_protection found = {.state = VDNA_PROTECTION_FALSE};
    cursor c = {value, size, size != VDNA_PROTECTION_BYTES};
    if (cursor_unsigned(&c, 1) != VERSION)
        return found;
    found.stream.id = cursor_unsigned(&c, sizeof found.stream.id);
    found.stream.sequence = cursor_unsigned(&c, sizeof found.stream.sequence);
    if (cursor_unsigned(&c, sizeof(uint32_t)) == checksum(message, picture_bytes, value))
        found.state = VDNA_PROTECTION_GOOD;
    return found;
}

/* see protection.h */
vdna_protection vdna_protection_read(const uint8_t *message, size_t message_bytes,
                                     size_t picture_bytes)
{
    vdna_protection found = {.state = VDNA_PROTECTION_NONE};
    const size_t before = FINGERPRINT_BYTES + FIELD_BYTES + picture_bytes;
    cursor c = {message + before, message_bytes - before, false};
    for (uint32_t left = cursor_count(&c); left > 0 && !c.broken; left--) {
        const uint32_t key_bytes = cursor_count(&c);
        const uint8_t *key = cursor_take(&c, key_bytes, 1);
        const uint32_t size = cursor_count(&c);
        const uint8_t *value = cursor_take(&c, size, 1);
        if (!value || key_bytes != sizeof VDNA_PROTECTION_KEY ||
            memcmp(key, VDNA_PROTECTION_KEY, sizeof VDNA_PROTECTION_KEY) != 0)
            continue;
        if (found.state != VDNA_PROTECTION_NONE)
            return (vdna_protection){.state = VDNA_PROTECTION_FALSE};
        found = read_value(message, picture_bytes, value, size);
    }
    return found;
}
