// Percentiles of millions of durations, in fixed memory.
#pragma once

#include <array>
#include <cstdint>

namespace vdna::selectord
{

// Counts durations in bins whose width doubles every 32 bins: exact below 64 us; above that, the
// middle of a bin is within 1/64 of every duration in it. The newest and the longest are exact.
class Durations
{
  public:
    // Clamped to 0 and to about 71 minutes.
    void add(int64_t us);

    uint64_t count() const { return count_; }
    int64_t newest_us() const { return newest_us_; }
    int64_t max_us() const { return max_us_; }
    // The percentile by nearest rank; 0 without durations.
    int64_t percentile_us(uint32_t percent) const;

  private:
    static constexpr uint32_t bins_per_doubling = 32;
    static constexpr uint32_t bins = 28 * bins_per_doubling; // up to 2^32

    static uint32_t bin_of(uint32_t us);
    static int64_t middle_of(uint32_t bin);

    std::array<uint64_t, bins> counts_{};
    uint64_t count_ = 0;
    int64_t newest_us_ = 0;
    int64_t max_us_ = 0;
};

} // namespace vdna::selectord
