// Histograms of the activations of traversals.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <vdna/cpp/taps.hpp>

#include "eval/counts.hpp"
#include "eval/frames.hpp"

namespace vdna::eval
{

// Counts activations of the selected taps. Repeated counts come from the cache of the frames.
class Binning
{
  public:
    // frames: borrowed. taps: names; none = all of the backbone's. Throws Error for an unknown one.
    Binning(Frames &frames, const std::vector<std::string> &taps, uint32_t range_rule);

    uint32_t neurons() const { return neurons_; }
    const std::vector<Tap> &taps() const { return taps_; } // positions among the counted neurons
    std::string taps_text() const;                         // as in an identity

    // [neurons][2], from all frames of these traversals.
    std::vector<float> range_of(const std::vector<size_t> &traversals);
    // Of all frames of a traversal.
    Counts counts_of(size_t traversal, const std::vector<float> &range, uint32_t bins);
    // Of some that follow one another; not cached.
    Counts counts_of(size_t traversal, const std::vector<float> &range, uint32_t bins,
                     uint32_t first, uint32_t frames);

    // The counted activations of one frame; borrowed until the next call.
    const std::vector<vdna_activations> &activations_of(size_t traversal, uint32_t frame);
    // Cache key of a result computed (as `how` says) from the first frames of a traversal.
    std::string key_of(const std::string &how, size_t traversal, uint32_t frames) const;

  private:
    const std::vector<float> &observed(size_t traversal);
    std::vector<float> observe(size_t traversal);
    std::optional<Counts> find_counts(const std::string &key, uint32_t bins) const;

    Frames &frames_;
    uint32_t range_rule_;
    uint32_t neurons_ = 0;
    std::vector<size_t> indices_; // of the selected taps among the backbone's
    std::vector<Tap> taps_;
    std::vector<vdna_activations> picked_;
    std::vector<std::vector<float>>
        observed_; // [traversals], minima and maxima, computed on demand
};

} // namespace vdna::eval
