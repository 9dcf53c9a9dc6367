#include "eval/counts.hpp"

#include <numeric>

namespace vdna::eval
{

vdna_hist_view Counts::view(const std::vector<float> &range) const
{
    return {range.data(), counts.data(), mass.data(), static_cast<uint32_t>(mass.size()), bins};
}

bool Counts::is_worth_keeping() const
{
    return std::accumulate(mass.begin(), mass.end(), uint64_t{0}) > counts.size();
}

Counts counts_of(const vdna_hist_view &histogram)
{
    const size_t neurons = histogram.neurons;
    return {histogram.bins,
            {histogram.counts, histogram.counts + neurons * histogram.bins},
            {histogram.mass, histogram.mass + neurons}};
}

} // namespace vdna::eval
