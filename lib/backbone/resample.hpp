// Resizing that OpenCV does slowly or not at all: each output pixel is a weighted sum of source
// pixels, rows and columns apart.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace vdna::backbone
{

// The source pixels of each output pixel along one axis, and their weights.
template <class Weight>
struct Taps {
    struct Span {
        int first, count;  // source pixels
        size_t weights_at; // of the first one, in `weights`
    };
    std::vector<Span> spans; // [output pixels]
    std::vector<Weight> weights;
};

// Weights as Pillow's Image.resize(..., BICUBIC) has them: a = -0.5, widened by the ratio where the
// picture shrinks, in units of 2^-22.
Taps<int32_t> pillow_bicubic_taps(int from, int to);

// The mean colour of the area that each output pixel covers, as cv::INTER_AREA has it but for the
// order of sums in float.
class AreaResampler
{
  public:
    // All memory that any picture needs is allocated here.
    explicit AreaResampler(cv::Size to);

    // From now on pictures are of size `from`, no side shorter than that of `to`.
    void prepare(cv::Size from);

    // One row of the output, rounded. picture: the pixels of a Picture.
    void row(const cv::Mat &picture, int y, uint8_t *out);

  private:
    cv::Size to_;
    Taps<float> rows_, columns_;
    std::vector<float> sums_; // over rows, [width of the picture][channels]
};

// As Pillow does it, to the last bit: columns first, and rounded to 8 bits between the passes.
class PillowResampler
{
  public:
    PillowResampler(cv::Size from, cv::Size to);

    // picture: 8 bits, any channels, of size `from`.
    void run(const cv::Mat &picture, cv::Mat &out);

  private:
    Taps<int32_t> rows_, columns_;
    cv::Mat narrow_; // [from.height][to.width]
    std::vector<int32_t> sums_;
};

} // namespace vdna::backbone
