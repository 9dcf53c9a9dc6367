// From pixels to what a network is fed with.
#pragma once

#include <array>
#include <vector>

#include "manifest.hpp"
#include "picture/decode.hpp"
#include "picture/resample.hpp"

namespace vdna::backbone
{

class Preprocessor
{
  public:
    // All memory that any picture needs is allocated here.
    explicit Preprocessor(const Input &input);

    // The least size that a JPEG picture may be decoded at.
    picture::Size least() const { return least_; }

    // Resize, order the channels, subtract the mean and divide by std.
    // @param out  [3][height][width] of the network's input, written in full
    void run(const vdna_pixels &pixels, float *out);

  private:
    using Table = std::array<float, 256>;

    void normalise_row(const vdna_pixels &pixels, size_t y, float *out) const;

    picture::Size size_, least_;
    std::array<size_t, 3> order_; // which of red, green, blue each channel of the network is
    std::array<Table, 3> tables_; // per channel of the network: 8-bit level -> normalised
    picture::Resampler resampler_;
    std::vector<uint8_t> row_; // one of the resized picture
};

} // namespace vdna::backbone
