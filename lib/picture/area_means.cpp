#include "area_means.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "rounding.hpp"
#include "vectorised.h"

namespace vdna::picture
{

namespace
{

// Each source pixel weighs by how much of it the output pixel covers. from >= to.
void fill_taps(uint32_t from, uint32_t to, Taps<float> &taps)
{
    taps.clear();
    const double scale = static_cast<double>(from) / to;
    for (uint32_t i = 0; i < to; i++) {
        const double begin = i * scale, end = std::min(begin + scale, static_cast<double>(from));
        const auto first = static_cast<uint32_t>(begin);
        const uint32_t last = std::min(static_cast<uint32_t>(std::ceil(end)), from);
        taps.spans.push_back({first, last - first, taps.weights.size()});
        for (uint32_t pixel = first; pixel < last; pixel++) {
            const double covered = std::min(end, pixel + 1.0) - std::max<double>(begin, pixel);
            taps.weights.push_back(static_cast<float>(covered / (end - begin)));
        }
    }
}

VDNA_VECTORISED void set_row(const uint8_t *row, float weight, size_t count, float *sums)
{
    for (size_t i = 0; i < count; i++)
        sums[i] = weight * static_cast<float>(row[i]);
}

VDNA_VECTORISED void add_row(const uint8_t *row, float weight, size_t count, float *sums)
{
    for (size_t i = 0; i < count; i++)
        sums[i] += weight * static_cast<float>(row[i]);
}

} // namespace

AreaMeans::AreaMeans(Size to)
    // Left uninitialised, so that it is not resident before a picture needs it.
    : to_(to), sums_(new float[(size_t{VDNA_IMAGE_SIDE_MAX} + 1) * channels_max])
{
    // Room for any picture: neighbouring output pixels share at most one source pixel.
    rows_.reserve(to.height, size_t{VDNA_IMAGE_SIDE_MAX} + to.height);
    columns_.reserve(to.width, size_t{VDNA_IMAGE_SIDE_MAX} + to.width);
}

void AreaMeans::begin(const vdna_pixels &picture)
{
    picture_ = picture;
    next_ = 0;
    // The last pixel is read as if it had four channels.
    std::fill_n(&sums_[size_t{picture.width} * picture.channels], channels_max, 0.0f);
    if (size_of(picture) == from_)
        return;
    from_ = size_of(picture);
    fill_taps(from_.height, to_.height, rows_);
    fill_taps(from_.width, to_.width, columns_);
}

// Set sums_ to the weighted sum of the rows of a span.
void AreaMeans::add_rows(const Taps<float>::Span &span)
{
    const size_t count = size_t{picture_.width} * picture_.channels;
    const uint8_t *row = picture_.data + span.first * picture_.stride;
    const float *weight = &rows_.weights[span.weights_at];
    set_row(row, weight[0], count, sums_.get());
    for (uint32_t i = 1; i < span.count; i++)
        add_row(row + i * picture_.stride, weight[i], count, sums_.get());
}

void AreaMeans::next_row(uint8_t *out)
{
    // Add four numbers at a time, whatever the number of channels; ignore the excess.
    using Four = float __attribute__((vector_size(channels_max * sizeof(float))));
    const size_t channels = picture_.channels;
    add_rows(rows_.spans[next_++]);
    for (const Taps<float>::Span &span : columns_.spans) {
        const float *pixel = &sums_[span.first * channels];
        const float *weight = &columns_.weights[span.weights_at];
        Four sum = {};
        for (uint32_t i = 0; i < span.count; i++, pixel += channels) {
            Four four;
            std::memcpy(&four, pixel, sizeof four);
            sum += four * weight[i];
        }
        for (size_t c = 0; c < channels; c++)
            *out++ = level_of(sum[c]);
    }
}

} // namespace vdna::picture
