#include "record/thumbnails.hpp"

#include <vdna/cpp/error.hpp>
#include <vdna/map.h>

namespace vdna::record
{

std::string Thumbnails::of(const frames::Frame &frame)
{
    vdna_pixels pixels;
    vdna_error error{};
    require(vdna_decoder_decode_reduced(decoder_.get(), &frame.image, side_max, side_max, &error,
                                        &pixels),
            error);
    return picture::jpeg_within(shrinker_.shrink(pixels), VDNA_THUMBNAIL_MAX);
}

} // namespace vdna::record
