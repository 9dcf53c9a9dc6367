// Repeatable random numbers: a seed gives the same draws with every compiler and library.
#pragma once

#include <cstdint>

namespace vdna::simulate
{

class Chance
{
  public:
    explicit Chance(uint64_t seed) : state_(seed) {}

    // splitmix64
    uint64_t next()
    {
        uint64_t z = state_ += 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    float unit() { return static_cast<float>(next() >> 40) * 0x1p-24f; } // 0 <= x < 1
    float between(float lo, float hi) { return lo + (hi - lo) * unit(); }
    bool happens(float probability) { return unit() < probability; }
    uint32_t below(uint32_t count) { return static_cast<uint32_t>(next() >> 32) % count; }

  private:
    uint64_t state_;
};

// A separate seed for each part of the object with this seed.
inline uint64_t seed_of_part(uint64_t seed, uint64_t part)
{
    return Chance(seed ^ Chance(part).next()).next();
}

} // namespace vdna::simulate
