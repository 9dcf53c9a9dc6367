#include "selectord/durations.hpp"

#include <algorithm>

namespace vdna::selectord
{

void Durations::add(int64_t us)
{
    newest_us_ = std::clamp<int64_t>(us, 0, UINT32_MAX);
    max_us_ = std::max(max_us_, newest_us_);
    counts_[bin_of(static_cast<uint32_t>(newest_us_))]++;
    count_++;
}

int64_t Durations::percentile_us(uint32_t percent) const
{
    // Divide before multiplying, so that no count overflows; round up to a whole rank.
    const uint64_t rank = count_ / 100 * percent + (count_ % 100 * percent + 99) / 100;
    uint64_t below = 0;
    for (uint32_t bin = 0; bin < bins; bin++) {
        below += counts_[bin];
        if (counts_[bin] > 0 && below >= rank)
            return std::min(middle_of(bin), max_us_);
    }
    return 0;
}

uint32_t Durations::bin_of(uint32_t us)
{
    // The first 64 bins are 1 us wide; each further doubling has 32 bins.
    uint32_t shift = 0;
    while (us >> shift >= 2 * bins_per_doubling)
        shift++;
    return shift * bins_per_doubling + (us >> shift);
}

int64_t Durations::middle_of(uint32_t bin)
{
    if (bin < 2 * bins_per_doubling)
        return bin;
    const uint32_t shift = bin / bins_per_doubling - 1;
    const int64_t first = static_cast<int64_t>(bin - shift * bins_per_doubling) << shift;
    return first + (int64_t{1} << shift) / 2;
}

} // namespace vdna::selectord
