#include "selectord/glance.hpp"

namespace vdna::selectord
{

namespace
{

// Several pixels for each block that is measured.
constexpr uint32_t least_width = 64, least_height = 48;

constexpr uint64_t pixel_bytes = 3;

} // namespace

Glance::Glance(uint32_t max_pixels) : decoder_(open_decoder(max_pixels)) {}

bool Glance::look(const vdna_image &image, vdna_parked_picture &out_picture)
{
    vdna_pixels pixels;
    return vdna_decoder_decode_reduced(decoder_.get(), &image, least_width, least_height, nullptr,
                                       &pixels) == VDNA_OK &&
           vdna_parked_measure(&pixels, &out_picture) == VDNA_OK;
}

uint64_t Glance::bytes_max(uint32_t max_pixels)
{
    return pixel_bytes * (uint64_t{max_pixels} + VDNA_IMAGE_SIDE_MAX);
}

} // namespace vdna::selectord
