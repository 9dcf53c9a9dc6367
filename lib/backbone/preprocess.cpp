#include "preprocess.hpp"

namespace vdna::backbone
{

Preprocessor::Preprocessor(const Input &input)
    : size_{input.width, input.height}, least_(input.reduced ? size_ : picture::Decoder::whole),
      order_(input.bgr ? std::array<size_t, 3>{2, 1, 0} : std::array<size_t, 3>{0, 1, 2}),
      tables_(), resampler_(input.interpolation, size_), row_(input.width * picture::channels_max)
{
    for (size_t c = 0; c < tables_.size(); c++)
        for (size_t level = 0; level < tables_[c].size(); level++)
            tables_[c][level] =
                static_cast<float>((static_cast<double>(level) - input.mean[c]) / input.std[c]);
}

void Preprocessor::run(const vdna_pixels &pixels, float *out)
{
    resampler_.begin(pixels);
    for (size_t y = 0; y < size_.height; y++) {
        resampler_.next_row(row_.data());
        normalise_row(pixels, y, out);
    }
}

// Row y of all channels of the network, from row_.
void Preprocessor::normalise_row(const vdna_pixels &pixels, size_t y, float *out) const
{
    for (size_t c = 0; c < tables_.size(); c++) {
        const Table &table = tables_[c];
        const uint8_t *level = row_.data() + pixels.rgb[order_[c]];
        float *to = out + (c * size_.height + y) * size_.width;
        for (size_t x = 0; x < size_.width; x++)
            to[x] = table[level[x * pixels.channels]];
    }
}

} // namespace vdna::backbone
