// The mean colour of the block of source pixels that each output pixel covers.
#pragma once

#include "resample.hpp"

namespace vdna::picture
{

// cv::INTER_AREA where both ratios are whole. It sums integers and rounds in two ways.
class BlockMeans : public Method
{
  public:
    explicit BlockMeans(Size to);

    void begin(const vdna_pixels &picture) override;
    void next_row(uint8_t *out) override;

  private:
    Size to_;
    vdna_pixels picture_{};
    uint32_t next_ = 0;                // row of the output
    std::unique_ptr<uint32_t[]> sums_; // over the rows of a block, [width of the picture][channels]
};

} // namespace vdna::picture
