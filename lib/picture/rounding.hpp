// Rounding to 8-bit levels.
#pragma once

#include <algorithm>
#include <cstdint>

namespace vdna::picture
{

// Round to nearest, halves to even; value: -0.5..255.5. It calls nothing, so loops over it
// vectorise.
inline uint8_t level_of(float value)
{
    constexpr float shift = 12582912.0f; // 1.5 * 2^23: above it floats are whole
    return static_cast<uint8_t>(value + shift - shift);
}

} // namespace vdna::picture
