// Thumbnails of frames, as experience files have them.
#pragma once

#include <memory>
#include <string>

#include <vdna/picture.h>

#include "frames/source.hpp"
#include "picture/small_jpeg.hpp"

namespace vdna::record
{

class Thumbnails
{
  public:
    Thumbnails();

    // A JPEG of at most VDNA_THUMBNAIL_MAX bytes; "" for a picture of which there is none so small.
    // frame: one that the network took, as Pass gives it. Throws Error.
    std::string of(const frames::Frame &frame);

    static constexpr uint32_t side_max = 160; // pixels

  private:
    std::unique_ptr<vdna_decoder, decltype(&vdna_decoder_close)> decoder_;
    picture::Shrinker shrinker_{side_max};
};

} // namespace vdna::record
