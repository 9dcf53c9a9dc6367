/* Private: reading an LCM message in place, never past its end. All numbers are big-endian. */
#ifndef VDNA_CURSOR_H
#define VDNA_CURSOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* A read position. The first read that does not fit sets `broken`; from then on every read gives 0
 * or NULL, so a parser reads a message straight through and asks once, at its end. */
typedef struct cursor {
    const uint8_t *at;
    size_t left; /* bytes */
    bool broken;
} cursor;

/* The next `count` elements of `size` bytes each, or NULL. */
static inline const uint8_t *cursor_take(cursor *c, size_t count, size_t size)
{
    if (c->broken || count > c->left / size) {
        c->broken = true;
        return NULL;
    }
    const uint8_t *taken = c->at;
    c->at += count * size;
    c->left -= count * size;
    return taken;
}

static inline uint64_t cursor_unsigned(cursor *c, size_t size)
{
    const uint8_t *bytes = cursor_take(c, size, 1);
    uint64_t value = 0;
    for (size_t i = 0; bytes && i < size; i++)
        value = value << 8 | bytes[i];
    return value;
}

static inline int64_t cursor_int64(cursor *c)
{
    return (int64_t)cursor_unsigned(c, sizeof(int64_t));
}

/* A width, length or count: an int32 on the wire that must not be negative. */
static inline uint32_t cursor_count(cursor *c)
{
    const uint32_t count = (uint32_t)cursor_unsigned(c, sizeof(int32_t));
    if (count <= INT32_MAX)
        return count;
    c->broken = true;
    return 0;
}

/* Skip strings: the length of each counts the one NUL at its end. */
static inline void cursor_strings(cursor *c, uint32_t count)
{
    for (uint32_t i = 0; i < count && !c->broken; i++) {
        const uint32_t length = cursor_count(c);
        const uint8_t *text = cursor_take(c, length, 1);
        if (text && (length == 0 || memchr(text, 0, length) != text + length - 1))
            c->broken = true;
    }
}

/* The fingerprint of a message of any type; 0 if the message is too short for one. */
static inline uint64_t cursor_fingerprint(const void *data, size_t size)
{
    cursor c = {data, size, !data};
    return cursor_unsigned(&c, sizeof(uint64_t));
}

/* A cursor behind the fingerprint; broken if the message is of another type. Generated decoders
 * take the size as an int, so a larger message is broken too. */
static inline cursor cursor_begin(const void *data, size_t size, uint64_t fingerprint)
{
    cursor c = {data, size, !data || size > INT32_MAX};
    if (cursor_unsigned(&c, sizeof fingerprint) != fingerprint)
        c.broken = true;
    return c;
}

/* True if the whole message was read and nothing is left. */
static inline bool cursor_complete(const cursor *c)
{
    return !c->broken && c->left == 0;
}

#endif
