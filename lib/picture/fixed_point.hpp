// Two or four source pixels per output pixel and axis, with weights in units of 2^-11.
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

// OpenCV's resizing of 8-bit pictures: columns first, into integers, then rows, rounded once.
class FixedPoint : public Method
{
  public:
    // linear, cubic: cv::INTER_LINEAR, cv::INTER_CUBIC. grown_area: cv::INTER_AREA if a side grows:
    // linear, but output pixels within one source pixel take its colour.
    enum class Kernel { linear, cubic, grown_area };

    FixedPoint(Kernel kernel, Size to);

    void begin(const vdna_pixels &picture) override;
    void next_row(uint8_t *out) override;

  private:
    static constexpr size_t taps_max = 4;

    // The source pixels of an output pixel along one axis.
    struct Weighed {
        int32_t first; // may lie outside the picture: then the outermost pixel is taken
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
    uint32_t within_row_ = 0; // output pixels whose taps leave four bytes to the end of the row
    std::array<std::vector<int32_t>, taps_max> narrow_; // rows of the picture with columns done
    std::array<int64_t, taps_max> narrow_of_{};         // which rows; -1: none
};

} // namespace vdna::picture
