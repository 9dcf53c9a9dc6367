#include "pillow_bicubic.hpp"

#include <algorithm>
#include <cmath>

#include "vectorised.h"

namespace vdna::picture
{

namespace
{

constexpr int bits = 22;
constexpr int32_t half = 1 << (bits - 1);
constexpr double support = 2.0; // source pixels to either side, unless the picture shrinks

// Keys' cubic convolution with a = -0.5.
double bicubic(double x)
{
    constexpr double a = -0.5;
    x = std::fabs(x);
    if (x < 1.0)
        return ((a + 2.0) * x - (a + 3.0)) * x * x + 1.0;
    return x < 2.0 ? (((x - 5.0) * x + 8.0) * x - 4.0) * a : 0.0;
}

int32_t fixed(double weight)
{
    const double scaled = weight * (1 << bits);
    return static_cast<int32_t>(scaled < 0 ? scaled - 0.5 : scaled + 0.5);
}

uint8_t level_of(int32_t sum)
{
    return static_cast<uint8_t>(std::clamp(sum >> bits, 0, 255));
}

// Upper bound of the source pixels that one output pixel depends on.
size_t span_max(uint32_t from, uint32_t to)
{
    const double scale = std::max(static_cast<double>(from) / to, 1.0);
    return std::min(static_cast<size_t>(2.0 * support * scale) + 2, size_t{from});
}

size_t weights_max(uint32_t to)
{
    return size_t{to} * span_max(VDNA_IMAGE_SIDE_MAX, to);
}

void narrow(const uint8_t *row, const Taps<int32_t> &taps, uint32_t channels, uint8_t *out)
{
    for (const Taps<int32_t>::Span &span : taps.spans)
        for (uint32_t c = 0; c < channels; c++) {
            int32_t sum = half;
            const uint8_t *pixel = row + span.first * size_t{channels} + c;
            const int32_t *weight = &taps.weights[span.weights_at];
            for (uint32_t i = 0; i < span.count; i++, pixel += channels)
                sum += *pixel * weight[i];
            *out++ = level_of(sum);
        }
}

VDNA_VECTORISED void add_row(const uint8_t *row, int32_t weight, size_t count, int32_t *sums)
{
    for (size_t i = 0; i < count; i++)
        sums[i] += weight * row[i];
}

VDNA_VECTORISED void round_row(const int32_t *sums, size_t count, uint8_t *out)
{
    for (size_t i = 0; i < count; i++)
        out[i] = level_of(sums[i]);
}

} // namespace

PillowBicubic::PillowBicubic(Size to)
    // narrow_ is left uninitialised, so that it is not resident before a picture needs it.
    : to_(to), kept_(span_max(VDNA_IMAGE_SIDE_MAX, to.height)),
      narrow_(new uint8_t[kept_ * to.width * channels_max]), sums_(to.width * channels_max)
{
    rows_.reserve(to.height, weights_max(to.height));
    columns_.reserve(to.width, weights_max(to.width));
    weights_.reserve(span_max(VDNA_IMAGE_SIDE_MAX, std::min(to.width, to.height)));
}

void PillowBicubic::begin(const vdna_pixels &picture)
{
    picture_ = picture;
    next_ = narrowed_ = 0;
    if (size_of(picture) == from_)
        return;
    from_ = size_of(picture);
    fill(rows_, from_.height, to_.height);
    fill(columns_, from_.width, to_.width);
}

void PillowBicubic::fill(Taps<int32_t> &taps, uint32_t from, uint32_t to)
{
    taps.clear();
    const double scale = static_cast<double>(from) / to;
    const double widening = std::max(scale, 1.0), reach = support * widening;
    for (uint32_t i = 0; i < to; i++) {
        const double centre = (i + 0.5) * scale;
        // NOLINTBEGIN(bugprone-incorrect-roundings): as Pillow does
        const auto first = static_cast<uint32_t>(std::max(centre - reach + 0.5, 0.0));
        const uint32_t last = std::min(static_cast<uint32_t>(centre + reach + 0.5), from);
        // NOLINTEND(bugprone-incorrect-roundings)
        weights_.clear();
        double total = 0.0;
        for (uint32_t pixel = first; pixel < last; pixel++) {
            weights_.push_back(bicubic((pixel - centre + 0.5) * (1.0 / widening)));
            total += weights_.back();
        }
        taps.spans.push_back({first, last - first, taps.weights.size()});
        for (const double weight : weights_)
            taps.weights.push_back(fixed(weight / total));
    }
}

uint8_t *PillowBicubic::narrow_row(uint32_t source_row)
{
    return &narrow_[source_row % kept_ * to_.width * channels_max];
}

void PillowBicubic::next_row(uint8_t *out)
{
    const Taps<int32_t>::Span &span = rows_.spans[next_++];
    for (; narrowed_ < span.first + span.count; narrowed_++)
        narrow(picture_.data + narrowed_ * picture_.stride, columns_, picture_.channels,
               narrow_row(narrowed_));

    const size_t count = size_t{to_.width} * picture_.channels;
    std::fill_n(sums_.begin(), count, half);
    for (uint32_t i = 0; i < span.count; i++)
        add_row(narrow_row(span.first + i), rows_.weights[span.weights_at + i], count,
                sums_.data());
    round_row(sums_.data(), count, out);
}

} // namespace vdna::picture
