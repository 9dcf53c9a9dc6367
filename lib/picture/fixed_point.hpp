// Linear and cubic resizing with 11-bit weights.
#pragma once

#include <array>
#include <vector>

#include "resample.hpp"

namespace vdna::picture
{

// A source pixel's share in an output pixel, along a row.
struct ColumnTap {
    uint32_t offset; // bytes from the beginning of the row
    float weight;    // a whole number
};

// Resizes as OpenCV does 8-bit pictures: first along the columns, into integers, then along the
// rows, rounding once.
class FixedPoint : public Method
{
  public:
    // linear, cubic: cv::INTER_LINEAR, cv::INTER_CUBIC. grown_area: cv::INTER_AREA where a side
    // grows. It blends linearly, but an output pixel within one source pixel takes its colour.
    enum class Kernel { linear, cubic, grown_area };

    FixedPoint(Kernel kernel, Size to);

    void begin(const vdna_pixels &picture) override;
    void next_row(uint8_t *out) override;

  private:
    static constexpr size_t taps_max = 4;

    // The source pixels of an output pixel along one axis.
    struct Weighed {
        int32_t first; // may lie outside the picture: then the outermost pixel counts
        std::array<int16_t, taps_max> weights;
    };

    void place(uint32_t from, std::vector<Weighed> &axis) const;
    void fill_column_taps();
    const int32_t *narrow_row(uint32_t source_row);

    Kernel kernel_;
    uint32_t taps_;
    Size to_, from_{};
    vdna_pixels picture_{};
    uint32_t next_ = 0; // row of the output
    std::vector<Weighed> rows_, columns_;
    std::vector<ColumnTap> column_taps_; // [width of the output][taps_]
    uint32_t within_row_ = 0; // leading output pixels whose taps may be read as four bytes
    std::array<std::vector<int32_t>, taps_max> narrow_; // source rows, resampled along columns
    std::array<int64_t, taps_max> narrow_of_{};         // which rows; -1: none
};

} // namespace vdna::picture
