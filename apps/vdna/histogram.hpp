// A histogram of the C99 core together with the memory it lives in.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <vdna/hist.h>

namespace vdna
{

class Histogram
{
  public:
    // range: [neurons][2], borrowed as long as the histogram is in use. Throws Error.
    Histogram(const std::vector<float> &range, uint32_t bins);

    // where: names the frame in complaints.
    void add(const vdna_activations *taps, size_t tap_count, const std::string &where);
    const vdna_hist *operator->() const { return &hist_; }
    // Share of all samples that lay beyond their range, 0..1.
    double saturated_share() const;

  private:
    std::vector<uint32_t> mem_;
    vdna_hist hist_{};
};

} // namespace vdna
