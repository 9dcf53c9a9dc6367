// The counts of a histogram, apart from the memory that they were counted in.
#pragma once

#include <cstdint>
#include <vector>

#include <vdna/hist.h>

namespace vdna::eval
{

struct Counts {
    uint32_t bins = 0;
    std::vector<uint32_t> counts; // [bins][neurons]
    std::vector<uint32_t> mass;   // [neurons]

    vdna_hist_view view(const std::vector<float> &range) const; // all borrowed
    // Counts of fewer samples than they have bins are counted again as fast as they are read.
    bool is_worth_keeping() const;
};

// A copy of a histogram's.
Counts counts_of(const vdna_hist_view &histogram);

} // namespace vdna::eval
