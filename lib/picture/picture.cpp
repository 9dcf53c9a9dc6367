#include <vdna/picture.h>

#include "decode.hpp"
#include "failure.hpp"
#include "mean_grey.hpp"

using namespace vdna;

struct vdna_decoder {
    picture::Decoder decoder;
};

/* see vdna/picture.h */
vdna_status vdna_decoder_open(uint32_t max_pixels, vdna_error *error, vdna_decoder **out_decoder)
{
    if (max_pixels < 1 || max_pixels > VDNA_IMAGE_PIXELS_MAX || !out_decoder)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "vdna_decoder_open: pictures of 1 to %u pixels are expected",
                         VDNA_IMAGE_PIXELS_MAX);
    return fail::guarded(error,
                         [&] { *out_decoder = new vdna_decoder{picture::Decoder(max_pixels)}; });
}

/* see vdna/picture.h */
void vdna_decoder_close(vdna_decoder *decoder)
{
    delete decoder;
}

/* see vdna/picture.h */
uint64_t vdna_decoder_bytes_max(uint32_t max_pixels)
{
    if (max_pixels < 1 || max_pixels > VDNA_IMAGE_PIXELS_MAX)
        return 0;
    return picture::Decoder::bytes_max(max_pixels);
}

/* see vdna/picture.h */
vdna_status vdna_decoder_decode(vdna_decoder *decoder, const vdna_image *image, vdna_error *error,
                                vdna_pixels *out_pixels)
{
    if (!decoder || !image || !out_pixels)
        return vdna_fail(error, VDNA_ERR_ARG,
                         "vdna_decoder_decode: a decoder, an image and pixels are expected");
    return fail::guarded(error, [&] { *out_pixels = decoder->decoder.decode(*image); });
}

/* see vdna/picture.h */
vdna_status vdna_decoder_decode_reduced(vdna_decoder *decoder, const vdna_image *image,
                                        uint32_t least_width, uint32_t least_height,
                                        vdna_error *error, vdna_pixels *out_pixels)
{
    if (!decoder || !image || !out_pixels)
        return vdna_fail(
            error, VDNA_ERR_ARG,
            "vdna_decoder_decode_reduced: a decoder, an image and pixels are expected");
    return fail::guarded(
        error, [&] { *out_pixels = decoder->decoder.decode(*image, {least_width, least_height}); });
}

/* see vdna/picture.h */
float vdna_pixels_mean_grey(const vdna_pixels *pixels)
{
    return pixels ? picture::mean_grey(*pixels) : 0.0f;
}
