// Resizing of 8-bit pictures, with all memory taken before the first one.
#pragma once

#include <memory>

#include <vdna/picture.h>

namespace vdna::picture
{

// area, linear and cubic give the bytes of OpenCV's INTER_AREA, INTER_LINEAR and INTER_CUBIC (where
// area sums floats, halves may round otherwise); pillow_bicubic gives those of Python's Pillow.
enum class Interpolation { area, linear, cubic, pillow_bicubic };

struct Size {
    uint32_t width, height; // pixels

    bool operator==(const Size &other) const
    {
        return width == other.width && height == other.height;
    }
    bool operator!=(const Size &other) const { return !(*this == other); }
};

inline Size size_of(const vdna_pixels &pixels)
{
    return {pixels.width, pixels.height};
}

constexpr size_t channels_max = 4;

// One way to resize. For each picture: begin(), then next_row() for each row of the output.
class Method
{
  public:
    virtual ~Method() = default;
    // picture: borrowed until next_row() has given the last row.
    virtual void begin(const vdna_pixels &picture) = 0;
    // Write the next row, top row first, with the channels of the picture.
    virtual void next_row(uint8_t *out) = 0;
};

// Resizes pictures of any size to one size. All memory is allocated on construction.
class Resampler
{
  public:
    // to: sides of 1..VDNA_IMAGE_SIDE_MAX
    Resampler(Interpolation interpolation, Size to);

    // see Method
    void begin(const vdna_pixels &picture);
    void next_row(uint8_t *out) { method_->next_row(out); }

  private:
    Method &method_for(Size from) const;

    Interpolation interpolation_;
    Size to_;
    std::unique_ptr<Method> usual_;   // for most ratios
    std::unique_ptr<Method> whole_;   // for whole ratios, which OpenCV rounds differently
    std::unique_ptr<Method> growing_; // `area` where a side grows
    Method *method_ = nullptr;        // of the current picture
};

} // namespace vdna::picture
