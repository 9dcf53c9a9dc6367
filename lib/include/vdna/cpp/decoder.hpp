/** @file vdna/cpp/decoder.hpp
 *  @brief A decoder of pictures; it closes itself.
 */
#ifndef VDNA_CPP_DECODER_HPP
#define VDNA_CPP_DECODER_HPP

#include <cstdint>
#include <memory>

#include <vdna/cpp/error.hpp>
#include <vdna/picture.h>

namespace vdna
{

struct CloseDecoder {
    void operator()(vdna_decoder *decoder) const { vdna_decoder_close(decoder); }
};

using Decoder = std::unique_ptr<vdna_decoder, CloseDecoder>;

/** Of pictures of at most `max_pixels` pixels, as vdna_decoder_open() says; throws Error. */
inline Decoder open_decoder(uint32_t max_pixels)
{
    vdna_decoder *decoder = nullptr;
    vdna_error error{};
    require(vdna_decoder_open(max_pixels, &error, &decoder), error);
    return Decoder(decoder);
}

} // namespace vdna

#endif
