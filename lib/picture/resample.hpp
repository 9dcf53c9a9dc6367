// Resizing of 8-bit pictures, with all memory taken before the first one.
#pragma once

#include <memory>

#include <vdna/picture.h>

namespace vdna::picture
{

// area, linear, cubic: OpenCV's INTER_AREA, INTER_LINEAR and INTER_CUBIC, to the last bit.
// pillow_bicubic: Python's Pillow, to the last bit.
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
    // picture: borrowed until its last row has been asked for.
    virtual void begin(const vdna_pixels &picture) = 0;
    // The next row from the top: as many channels as the picture has.
    virtual void next_row(uint8_t *out) = 0;
};

// Any picture to one size.
class Resampler
{
  public:
    // to: sides of 1..VDNA_IMAGE_SIDE_MAX
    Resampler(Interpolation interpolation, Size to);

    // As a Method does.
    void begin(const vdna_pixels &picture);
    void next_row(uint8_t *out) { method_->next_row(out); }

  private:
    Method &method_for(Size from) const;

    Interpolation interpolation_;
    Size to_;
    std::unique_ptr<Method> usual_;   // by the interpolation's name
    std::unique_ptr<Method> whole_;   // for whole ratios, which OpenCV rounds differently
    std::unique_ptr<Method> growing_; // `area` if a side grows
    Method *method_ = nullptr;        // of the current picture
};

} // namespace vdna::picture
