// Thumbnails of frames, as experience files have them.
#pragma once

#include <string>

#include <vdna/cpp/decoder.hpp>

#include "frames/source.hpp"
#include "picture/small_jpeg.hpp"

namespace vdna::record
{

class Thumbnails
{
  public:
    // A JPEG of at most VDNA_THUMBNAIL_MAX bytes; "" for a picture of which there is none so small.
    // frame: one that the network took, as Pass gives it. Throws Error.
    std::string of(const frames::Frame &frame);

    static constexpr uint32_t side_max = 160; // pixels
    // To decode one, whose file may be anybody's.
    static constexpr uint32_t pixels_max = 1u << 20;

  private:
    Decoder decoder_ = open_decoder(VDNA_IMAGE_PIXELS_MAX);
    picture::Shrinker shrinker_{side_max};
};

} // namespace vdna::record
