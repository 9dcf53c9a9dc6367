// Frames whose bytes follow from their stamp, so that a receiver can tell any other byte.
#ifndef FRAMES_H
#define FRAMES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

static inline uint64_t frame_word(int64_t utime, size_t index)
{
    uint64_t x = ((uint64_t)utime + 1) * 0x9E3779B97F4A7C15u + index * 0xBF58476D1CE4E5B9u;
    x ^= x >> 29;
    return x * 0x94D049BB133111EBu;
}

static inline void frame_fill(uint8_t *out_bytes, size_t size, int64_t utime)
{
    for (size_t at = 0; at < size; at += sizeof(uint64_t)) {
        const uint64_t word = frame_word(utime, at);
        memcpy(out_bytes + at, &word, size - at < sizeof word ? size - at : sizeof word);
    }
}

static inline bool frame_is_right(const uint8_t *bytes, size_t size, int64_t utime)
{
    for (size_t at = 0; at < size; at += sizeof(uint64_t)) {
        const uint64_t word = frame_word(utime, at);
        if (memcmp(bytes + at, &word, size - at < sizeof word ? size - at : sizeof word) != 0)
            return false;
    }
    return true;
}

#endif
