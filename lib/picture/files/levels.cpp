#include "picture/files/levels.hpp"

#include "picture/files/bytes.hpp"

namespace vdna::picture
{

void check_depth(uint32_t largest)
{
    constexpr uint32_t common_bits[] = {8, 10, 12, 14}; // of the cameras in question
    if (largest == 0)                                   // black at any depth
        return;
    for (const uint32_t bits : common_bits)
        if (largest < 1u << bits)
            unsupported("has 16 bits a channel, but no value above " + std::to_string(largest) +
                        ", as if " + std::to_string(bits) +
                        " bits were significant; scale its values to 0..65535, or save it as "
                        "PGM or PPM, whose header gives the value of white");
}

} // namespace vdna::picture
