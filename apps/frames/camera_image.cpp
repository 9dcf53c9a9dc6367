#include "frames/camera_image.hpp"

#include <failure.hpp>

#include "frames/source.hpp"

namespace vdna::frames
{

vdna_image camera_image(const vdna_image &image, const std::string &name,
                        picture::FileConverter &converter)
{
    if (image.pixelformat != VDNA_PIXEL_ENCODED)
        return image;
    try {
        return converter.convert(image.data, image.size);
    } catch (const fail::Failure &failure) {
        const std::string sentence = name + ": " + failure.what();
        if (failure.status() == VDNA_ERR_NOMEM)
            throw Error(sentence);
        throw BadFrame(sentence);
    }
}

} // namespace vdna::frames
