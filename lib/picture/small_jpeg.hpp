// Small JPEGs of pictures, for people to look at.
#pragma once

#include <memory>
#include <string>

#include "resample.hpp"

namespace vdna::picture
{

// Makes pictures smaller, one after the other. Allocates when their size changes.
class Shrinker
{
  public:
    // side_max: of the longer side, pixels, >= 1
    explicit Shrinker(uint32_t side_max) : side_max_(side_max) {}

    // The picture with no side longer than side_max and its aspect; itself if it is small enough.
    // Borrowed from the picture, or from this object until the next call.
    vdna_pixels shrink(const vdna_pixels &pixels);

  private:
    uint32_t side_max_;
    Size size_{0, 0};                      // that resampler_ makes
    std::unique_ptr<Resampler> resampler_; // null until it is needed
    std::string small_;                    // pixels
};

// The bytes of a JPEG file.
// quality: 1..100. Throws std::bad_alloc.
std::string jpeg_of(const vdna_pixels &pixels, int quality);

// A JPEG of at most `bytes_max`, at the best of a few qualities; "" if there is none so small.
// Throws std::bad_alloc.
std::string jpeg_within(const vdna_pixels &pixels, size_t bytes_max);

} // namespace vdna::picture
