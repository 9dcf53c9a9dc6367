// The mean colour of the area that each output pixel covers.
#pragma once

#include "resample.hpp"
#include "taps.hpp"

namespace vdna::picture
{

// cv::INTER_AREA if neither side grows and not both ratios are whole. Sums of floats, in an order
// that existing maps depend on.
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
