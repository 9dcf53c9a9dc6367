// Bicubic resizing as Pillow up to version 12 does it.
#pragma once

#include <vector>

#include "resample.hpp"
#include "taps.hpp"

namespace vdna::picture
{

// Resamples along the columns, rounds to 8 bits, then along the rows. Weights are 22-bit.
class PillowBicubic : public Method
{
  public:
    explicit PillowBicubic(Size to);

    void begin(const vdna_pixels &picture) override;
    void next_row(uint8_t *out) override;

  private:
    void fill(Taps<int32_t> &taps, uint32_t from, uint32_t to);
    uint8_t *narrow_row(uint32_t source_row);

    Size to_, from_{};
    vdna_pixels picture_{};
    uint32_t next_ = 0;     // row of the output
    uint32_t narrowed_ = 0; // source rows resampled along their columns
    Taps<int32_t> rows_, columns_;
    std::vector<double> weights_;       // scratch: those of one output pixel
    size_t kept_;                       // rows in narrow_
    std::unique_ptr<uint8_t[]> narrow_; // ring of the last narrowed rows
    std::vector<int32_t> sums_;         // over rows, [width of the output][channels]
};

} // namespace vdna::picture
