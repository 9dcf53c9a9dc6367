/* An input read as a program of calls: which one comes next, and its arguments, valid or not. */
#ifndef CALLS_H
#define CALLS_H

#include <float.h>
#include <math.h>
#include <string.h>

#include "fuzz.h"

/* What is left of an input. Past its end every byte is 0. */
typedef struct calls {
    const uint8_t *at, *end;
} calls;

static inline int has_more(const calls *c)
{
    return c->at < c->end;
}

static inline uint8_t next_byte(calls *c)
{
    return has_more(c) ? *c->at++ : 0;
}

/* A number below `limit`, which is 1..256. */
static inline uint32_t below(calls *c, uint32_t limit)
{
    return next_byte(c) % limit;
}

/* True once in `rarity` values of a byte, and false at the end of the input. */
static inline uint32_t seldom(calls *c, uint32_t rarity)
{
    return below(c, rarity) == rarity - 1;
}

/* Most often least..least + 7; seldom one of the numbers at which sizes wrap. */
static inline uint32_t any_count(calls *c, uint32_t least)
{
    static const uint32_t odd[] = {0, 0xFFFF, 0x10000, 0x10001, 0x7FFFFFFF, 0x80000000, UINT32_MAX};
    const uint32_t byte = next_byte(c);
    return byte < 240 ? least + byte % 8 : odd[byte % (sizeof odd / sizeof *odd)];
}

static inline int64_t any_int64(calls *c)
{
    uint64_t bits = 0;
    for (unsigned i = 0; i < sizeof bits; i++)
        bits = bits << 8 | next_byte(c);
    return (int64_t)bits;
}

/* Most often one of 240 numbers of -1..1; seldom one that few expect. */
static inline float any_float(calls *c)
{
    static const float odd[] = {NAN,    INFINITY, -INFINITY, FLT_MAX, -FLT_MAX, FLT_MIN,
                                1e-45f, -0.0f,    1e18f,     -1e9f,   2.0f,     -3.0f};
    const uint8_t byte = next_byte(c);
    if (byte < 240)
        return ((float)byte - 119.5f) / 120.0f;
    return odd[byte % (sizeof odd / sizeof *odd)];
}

/* An exact block of memory, so that sanitizers see the first byte beyond it; never NULL. */
static inline void *block_of(size_t size)
{
    void *block = malloc(size > 0 ? size : 1);
    MUST(block != NULL);
    memset(block, 0xA5, size);
    return block;
}

/* `count` numbers in an exact block. */
static inline float *floats_of(calls *c, size_t count)
{
    float *numbers = block_of(count * sizeof *numbers);
    for (size_t i = 0; i < count; i++)
        numbers[i] = any_float(c);
    return numbers;
}

static inline double *doubles_of(calls *c, size_t count)
{
    double *numbers = block_of(count * sizeof *numbers);
    for (size_t i = 0; i < count; i++)
        numbers[i] = any_float(c);
    return numbers;
}

static inline int all_finite(const float *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(numbers[i]))
            return 0;
    return 1;
}

/* A copy of memory before a call that should leave it alone. */
typedef struct snapshot {
    const void *of;
    void *bytes;
    size_t size;
} snapshot;

static inline snapshot snapshot_of(const void *of, size_t size)
{
    const snapshot s = {of, block_of(size), size};
    memcpy(s.bytes, of, size);
    return s;
}

/* Ends a snapshot; the memory must be as it was if `status` is an error. */
static inline void require_unchanged_on_error(snapshot s, int32_t status)
{
    MUST(status == 0 || memcmp(s.of, s.bytes, s.size) == 0);
    free(s.bytes);
}

/* Bytes of a seed. */
#define PROGRAM 1024u

/* A program to mutate: bytes of a fixed generator, different for each index. */
static inline size_t random_program(unsigned index, uint8_t *out)
{
    uint64_t state = index * 0x9E3779B97F4A7C15u + 1;
    for (size_t i = 0; i < PROGRAM; i++) {
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        out[i] = (uint8_t)((state * 2685821657736338717u) >> 56);
    }
    return PROGRAM;
}

#endif
