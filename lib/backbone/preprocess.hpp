// From pixels to what a network is fed with.
#pragma once

#include <array>

#include <opencv2/core.hpp>

#include "decode.hpp"
#include "manifest.hpp"

namespace vdna
{

class Preprocessor
{
  public:
    explicit Preprocessor(const Input &input);

    // Resize, order the channels, subtract the mean and divide by std.
    // @param out  [3][height][width] of the network's input, written in full
    void run(const Picture &picture, float *out);

  private:
    using Table = std::array<float, 256>;

    cv::Size size_;
    int interpolation_;           // cv::INTER_...
    std::array<size_t, 3> order_; // which of red, green, blue each channel of the network is
    std::array<Table, 3> tables_; // per channel of the network: 8-bit level -> normalised
    cv::Mat resized_;
};

} // namespace vdna
