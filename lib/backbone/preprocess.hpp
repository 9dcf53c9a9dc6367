// From pixels to what a network is fed with.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "decode.hpp"
#include "manifest.hpp"
#include "resample.hpp"

namespace vdna::backbone
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

    void prepare(cv::Size from);
    void normalise_row(const uint8_t *row, const Picture &picture, int y, float *out) const;

    cv::Size size_;
    Interpolation interpolation_;
    std::array<size_t, 3> order_; // which of red, green, blue each channel of the network is
    std::array<Table, 3> tables_; // per channel of the network: 8-bit level -> normalised

    // For pictures of size `from_`.
    cv::Size from_;
    bool by_area_ = false; // and not by OpenCV
    AreaResampler area_;
    std::optional<PillowResampler> pillow_;
    cv::Mat resized_;
    std::vector<uint8_t> row_;
};

} // namespace vdna::backbone
