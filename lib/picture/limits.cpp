#include "limits.hpp"

#include <string>

#include <vdna/image.h>

#include "failure.hpp"

namespace vdna::picture
{

void check_sides(uint32_t width, uint32_t height, uint32_t max_pixels)
{
    const std::string size = std::to_string(width) + "x" + std::to_string(height);
    if (width == 0 || height == 0)
        throw fail::Failure(VDNA_ERR_FORMAT, "picture: has no pixels: " + size);
    if (width > VDNA_IMAGE_SIDE_MAX || height > VDNA_IMAGE_SIDE_MAX || width * height > max_pixels)
        throw fail::Failure(VDNA_ERR_UNSUPPORTED,
                            "picture: " + size + " pixels are too many; the limit is " +
                                std::to_string(VDNA_IMAGE_SIDE_MAX) + " a side and " +
                                std::to_string(max_pixels) + " in all");
}

} // namespace vdna::picture
