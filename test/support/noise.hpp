// Repeatable noise.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

// Bytes of every kind: the ends of the range, and all between. As in test/golden/make_pillow.py.
inline std::vector<uint8_t> noise(size_t count)
{
    std::vector<uint8_t> bytes(count);
    uint32_t state = 1;
    for (uint8_t &byte : bytes) {
        state = state * 1664525u + 1013904223u;
        const uint32_t levels[] = {0, 255, state >> 16 & 255, state >> 8 & 255};
        byte = static_cast<uint8_t>(levels[state >> 30]);
    }
    return bytes;
}
