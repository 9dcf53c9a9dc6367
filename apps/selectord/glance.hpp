// A cheap look at a picture: enough to tell whether the camera still sees what it saw.
#pragma once

#include <vdna/cpp/decoder.hpp>
#include <vdna/parked.h>

namespace vdna::selectord
{

class Glance
{
  public:
    // A picture of more than `max_pixels` pixels is refused. Throws Error.
    explicit Glance(uint32_t max_pixels);

    // Measure a picture, a JPEG by an eighth of its sides. Returns false if it cannot be decoded:
    // whoever decodes it in full says why.
    bool look(const vdna_image &image, vdna_parked_picture &out_picture);

    // Upper bound of the memory that stays with it, beside that of decoding one picture in full.
    static uint64_t bytes_max(uint32_t max_pixels);

  private:
    Decoder decoder_;
};

} // namespace vdna::selectord
