// What the network made of pictures, kept so that it runs once per picture.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <vdna/backbone.h>

#include "eval/cache.hpp"

namespace vdna::eval
{

// What localisation and the baselines need of a frame.
struct CachedFrame {
    float grey = 0; // 0..255
    std::vector<float> embedding;

    vdna_backbone_frame view() const; // borrowed, without taps
};

// What histograms need of a frame. Moving it keeps the pointers.
struct CachedTaps {
    std::vector<vdna_activations> taps; // point into `values`
    std::vector<float> values;
};

// The entries of one network. The two parts of a frame are kept apart because a run whose
// histograms are cached needs no activations, which are by far the larger part.
class FrameCache
{
  public:
    // cache: borrowed.
    FrameCache(const Cache &cache, const vdna_backbone_info &backbone);

    // Of a picture's bytes and of everything about the network that shapes the numbers.
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
