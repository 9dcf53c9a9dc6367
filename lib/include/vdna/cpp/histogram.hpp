/** @file vdna/cpp/histogram.hpp
 *  @brief A histogram of the core, and its memory.
 */
#ifndef VDNA_CPP_HISTOGRAM_HPP
#define VDNA_CPP_HISTOGRAM_HPP

#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include <vdna/cpp/error.hpp>
#include <vdna/hist.h>

namespace vdna
{

class Histogram
{
  public:
    /** Make an empty one; throws Error.
     *  @param range  [neurons][2], borrowed as long as the histogram is in use */
    Histogram(const std::vector<float> &range, uint32_t bins)
    {
        vdna_hist_config config;
        vdna_hist_config_init(&config);
        config.neurons = static_cast<uint32_t>(range.size() / 2);
        config.bins = bins;
        config.range = range.data();
        memory_.resize(vdna_hist_mem_size(&config) / sizeof(uint32_t) + 1);
        require(vdna_hist_init(&config, memory_.data(), memory_.size() * sizeof(uint32_t), &hist_),
                "histogram");
    }

    /** Count a frame; throws Error.
     *  @param where  names the frame in the error */
    void add(const vdna_activations *taps, size_t tap_count, const std::string &where)
    {
        require(vdna_hist_add(&hist_, taps, tap_count), where);
    }

    const vdna_hist *operator->() const { return &hist_; }

    /** Borrowed from this histogram. */
    vdna_hist_view view() const
    {
        vdna_hist_view view{};
        vdna_hist_view_of(&hist_, &view);
        return view;
    }

    /** Share of all samples that lay beyond their range, 0..1. */
    double saturated_share() const
    {
        const auto sum = [&](const uint32_t *values) {
            return std::accumulate(values, values + hist_.neurons, 0.0);
        };
        return hist_.frames == 0 ? 0 : sum(hist_.saturated) / sum(hist_.mass);
    }

  private:
    std::vector<uint32_t> memory_;
    vdna_hist hist_{};
};

} // namespace vdna

#endif
