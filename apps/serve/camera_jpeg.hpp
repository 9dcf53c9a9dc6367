// Camera frames as JPEGs that a browser shows.
#pragma once

#include <string>

#include <vdna/cpp/decoder.hpp>

#include "picture/small_jpeg.hpp"

namespace vdna::serve
{

class CameraJpeg
{
  public:
    // A JPEG of at most as_received_max bytes as it came, undecoded; any other picture decoded,
    // no side longer than side_max, and encoded. Throws Error for one that cannot be decoded.
    std::string of(const vdna_image &image);

    static constexpr size_t as_received_max = 256 * 1024; // bytes
    static constexpr uint32_t side_max = 640;             // pixels
    static constexpr uint32_t pixels_max = 1u << 22;      // of a picture that must be decoded

  private:
    Decoder decoder_ = open_decoder(pixels_max);
    picture::Shrinker shrinker_{side_max};
};

} // namespace vdna::serve
