#include "levels.hpp"

namespace vdna::picture
{

uint32_t fewer_than_16_bits(uint32_t used)
{
    constexpr uint32_t common_bits[] = {8, 10, 12, 14}; // of the cameras in question
    for (const uint32_t bits : common_bits)
        if (used != 0 && used < 1u << bits) // black is black at any depth
            return bits;
    return 0;
}

std::string fewer_bits_text(uint32_t bits)
{
    return "has 16 bits a channel, but no value uses more than " + std::to_string(bits) +
           " of them; ";
}

} // namespace vdna::picture
