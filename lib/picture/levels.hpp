// Levels of other depths as levels of 8 bits.
#pragma once

#include <cstdint>
#include <string>

namespace vdna::picture
{

// White of 16 bits.
inline constexpr uint32_t white_of_16_bits = 65535;

// The nearest level of 8 bits. value: 0..white, which is 1..65535
constexpr uint8_t level_of(uint32_t value, uint32_t white)
{
    return static_cast<uint8_t>((value * 255 + white / 2) / white);
}

// How many bits a picture seems to have that names 16: cameras of 10 to 14 bits exist whose
// pictures call themselves 16-bit, and these would be nearly black. To scale by this number would
// let the depth change from frame to frame, so it serves to refuse the picture. used: the bits that
// any value has set Returns 8, 10, 12 or 14; 0 if more are used, or none.
uint32_t fewer_than_16_bits(uint32_t used);

// The begin of the complaint about such a picture.
std::string fewer_bits_text(uint32_t bits);

} // namespace vdna::picture
