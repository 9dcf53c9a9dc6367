// Choices of some things of many.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

namespace vdna::eval
{

// Different choices of `size` of the numbers below `count`, ascending in each: `most` drawn ones,
// or all if there are no more. size: 1..count. The same state of `random` gives the same.
std::vector<std::vector<uint32_t>> subsets_of(uint32_t count, uint32_t size, size_t most,
                                              std::mt19937 &random);

} // namespace vdna::eval
