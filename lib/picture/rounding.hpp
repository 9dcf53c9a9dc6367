// Numbers to the nearest 8-bit level.
#pragma once

#include <algorithm>
#include <cstdint>

namespace vdna::picture
{

// value: 0..255 and a little beyond. Halves go to the even level. No function call, so that loops
// over it vectorise.
inline uint8_t level_of(float value)
{
    constexpr float shift = 12582912.0f; // 1.5 * 2^23: above it floats are whole
    return static_cast<uint8_t>(value + shift - shift);
}

} // namespace vdna::picture
