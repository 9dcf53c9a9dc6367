// Network outputs of pictures, cached so that the network runs once per picture.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <vdna/backbone.h>

#include "eval/cache.hpp"

namespace vdna::eval
{

// The part of a frame that localisation and the baselines need.
struct CachedFrame {
    float grey = 0; // 0..255
    std::vector<float> embedding;
    std::vector<float> last_layer; // empty if the network gives none

    vdna_backbone_frame view() const; // borrowed, without taps
};

// The part of a frame that histograms need. Moving it keeps the pointers valid.
struct CachedTaps {
    std::vector<vdna_activations> taps; // point into `values`
    std::vector<float> values;
};

// The entries of one network. The two parts of a frame are separate entries, because a run with
// cached histograms does not need the activations, by far the larger part.
class FrameCache
{
  public:
    // cache: borrowed.
    FrameCache(const Cache &cache, const vdna_backbone_info &backbone);

    // Depends on the bytes of the picture and on everything in the network that affects results.
    std::string key_of(const std::vector<uint8_t> &picture) const;
    // Nothing if it is missing or damaged.
    std::optional<CachedFrame> find(const std::string &key) const;
    std::optional<CachedTaps> find_taps(const std::string &key) const;
    // Throws Error.
    void store(const std::string &key, const vdna_backbone_frame &frame) const;

  private:
    const Cache &cache_;
    std::string network_;
};

} // namespace vdna::eval
