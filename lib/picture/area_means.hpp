// The mean colour of the area that each output pixel covers.
#pragma once

#include "resample.hpp"
#include "taps.hpp"

namespace vdna::picture
{

// cv::INTER_AREA where neither side grows and at least one ratio is not whole. It sums floats, and
// the order of the sums shows in the bits that maps are made of: keep it.
class AreaMeans : public Method
{
  public:
    explicit AreaMeans(Size to);

    void begin(const vdna_pixels &picture) override;
    void next_row(uint8_t *out) override;

  private:
    void add_rows(const Taps<float>::Span &span);

    Size to_, from_{};
    vdna_pixels picture_{};
    uint32_t next_ = 0; // row of the output
    Taps<float> rows_, columns_;
    std::unique_ptr<float[]> sums_; // over rows, [width of the picture][channels]
};

} // namespace vdna::picture
