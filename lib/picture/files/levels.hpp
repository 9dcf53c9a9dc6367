// Levels of other depths as levels of 8 bits.
#pragma once

#include <cstdint>

namespace vdna::picture
{

// White of 16 bits.
inline constexpr uint32_t white_of_16_bits = 65535;

// The nearest level of 8 bits. value: 0..white, which is 1..65535
constexpr uint8_t level_of(uint32_t value, uint32_t white)
{
    return static_cast<uint8_t>((value * 255 + white / 2) / white);
}

// Check whether a picture whose white is that of 16 bits, and whose largest value is `largest`,
// uses them: cameras of 10 to 14 bits exist whose files call themselves 16-bit, and these would be
// nearly black. To guess a depth from the values would let it change from frame to frame. Throws
// Failure, VDNA_ERR_UNSUPPORTED.
void check_depth(uint32_t largest);

} // namespace vdna::picture
