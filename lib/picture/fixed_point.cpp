#include "fixed_point.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "rounding.hpp"
#include "vectorised.h"

namespace vdna::picture
{

namespace
{

constexpr int bits = 11;
constexpr float one = 1 << bits;

using Weights = std::array<int16_t, 4>;

// Where an output pixel lies between two source pixels.
struct Position {
    int32_t at;     // the one before it; -1 at the beginning
    float fraction; // 0..1
};

Position between(uint32_t i, double scale)
{
    const auto place = static_cast<float>((i + 0.5) * scale - 0.5);
    const auto at = static_cast<int32_t>(std::floor(place));
    return {at, place - static_cast<float>(at)};
}

Position grown(uint32_t i, double scale, double inverse)
{
    const auto at = static_cast<int32_t>(std::floor(i * scale));
    const auto beyond = static_cast<float>((i + 1) - (at + 1) * inverse);
    return {at, beyond <= 0 ? 0.0f : beyond - std::floor(beyond)};
}

int16_t fixed(float weight)
{
    return static_cast<int16_t>(std::lrint(weight * one));
}

Weights linear_weights(float fraction)
{
    return {fixed(1.0f - fraction), fixed(fraction), 0, 0};
}

// Keys' cubic convolution with a = -0.75.
Weights cubic_weights(float x)
{
    constexpr float a = -0.75f;
    const float y = 1.0f - x;
    const float first = ((a * (x + 1) - 5 * a) * (x + 1) + 8 * a) * (x + 1) - 4 * a;
    const float second = ((a + 2) * x - (a + 3)) * x * x + 1;
    const float third = ((a + 2) * y - (a + 3)) * y * y + 1;
    return {fixed(first), fixed(second), fixed(third), fixed(1.0f - first - second - third)};
}

using Four = float __attribute__((vector_size(channels_max * sizeof(float))));
using FourSums = int32_t __attribute__((vector_size(channels_max * sizeof(int32_t))));

// Widen four bytes.
[[gnu::always_inline]] inline FourSums load_levels(const uint8_t *bytes)
{
    using Bytes = uint8_t __attribute__((vector_size(16)));
    using Words = uint16_t __attribute__((vector_size(16)));
    Bytes low = {};
    std::memcpy(&low, bytes, channels_max);
    const auto words = reinterpret_cast<Words>(__builtin_shufflevector(
        low, Bytes{}, 0, 16, 1, 16, 2, 16, 3, 16, 4, 16, 5, 16, 6, 16, 7, 16));
    return reinterpret_cast<FourSums>(
        __builtin_shufflevector(words, Words{}, 0, 8, 1, 8, 2, 8, 3, 8));
}

// Resample one source row along its columns: each output pixel is the weighted sum of `Taps` source
// pixels. All pixels are treated as if they had four channels: the next pixel overwrites the
// excess. Floats hold these sums exactly, because they are whole and below 2^24.
template <uint32_t Taps>
VDNA_VECTORISED void narrow(const uint8_t *row, uint32_t channels, const ColumnTap *taps,
                            uint32_t width, int32_t *out)
{
    for (uint32_t x = 0; x < width; x++, taps += Taps, out += channels) {
        Four sum = {};
        for (uint32_t k = 0; k < Taps; k++)
            sum +=
                __builtin_convertvector(load_levels(row + taps[k].offset), Four) * taps[k].weight;
        const FourSums whole = __builtin_convertvector(sum, FourSums);
        std::memcpy(out, &whole, sizeof whole);
    }
}

// The same for the last pixels of a row, where reading four bytes would leave it.
void narrow_at_end(const uint8_t *row, uint32_t channels, const ColumnTap *taps, uint32_t taps_each,
                   uint32_t width, int32_t *out)
{
    for (uint32_t x = 0; x < width; x++, taps += taps_each)
        for (uint32_t c = 0; c < channels; c++) {
            float sum = 0.0f;
            for (uint32_t k = 0; k < taps_each; k++)
                sum += static_cast<float>(row[taps[k].offset + c]) * taps[k].weight;
            *out++ = static_cast<int32_t>(sum);
        }
}

// Each product drops its low bits separately, as OpenCV's 16-bit vectors do.
VDNA_VECTORISED void blend_two(const int32_t *const *rows, const int16_t *weights, size_t count,
                               uint8_t *out)
{
    const int32_t *const a = rows[0], *const b = rows[1];
    const int32_t of_a = weights[0], of_b = weights[1];
    for (size_t i = 0; i < count; i++)
        out[i] = static_cast<uint8_t>(
            ((of_a * (a[i] >> 4) >> 16) + (of_b * (b[i] >> 4) >> 16) + 2) >> 2);
}

VDNA_VECTORISED void blend_four(const int32_t *const *rows, const int16_t *weights, size_t count,
                                uint8_t *out)
{
    const int32_t *const a = rows[0], *const b = rows[1], *const c = rows[2], *const d = rows[3];
    constexpr float unit = 1.0f / (one * one);
    const float of_a = weights[0] * unit, of_b = weights[1] * unit, of_c = weights[2] * unit,
                of_d = weights[3] * unit;
    // OpenCV on x86-64 sums eight numbers at a time in float, and the remainder in integers.
    const size_t vectors = count / 8 * 8;
    for (size_t i = 0; i < vectors; i++) {
        const float sum = static_cast<float>(a[i]) * of_a +
                          (static_cast<float>(b[i]) * of_b +
                           (static_cast<float>(c[i]) * of_c + static_cast<float>(d[i]) * of_d));
        out[i] = level_of(std::clamp(sum, 0.0f, 255.0f));
    }
    for (size_t i = vectors; i < count; i++) {
        const int32_t sum =
            a[i] * weights[0] + b[i] * weights[1] + c[i] * weights[2] + d[i] * weights[3];
        constexpr int32_t half = 1 << (2 * bits - 1);
        out[i] = static_cast<uint8_t>(std::clamp((sum + half) >> 2 * bits, 0, 255));
    }
}

} // namespace

FixedPoint::FixedPoint(Kernel kernel, Size to)
    : kernel_(kernel), taps_(kernel == Kernel::cubic ? 4 : 2), to_(to), rows_(to.height),
      columns_(to.width), column_taps_(size_t{to.width} * taps_)
{
    for (uint32_t k = 0; k < taps_; k++)
        narrow_[k].resize((size_t{to.width} + 1) * channels_max);
}

void FixedPoint::begin(const vdna_pixels &picture)
{
    const bool is_new_size = size_of(picture) != from_;
    const bool are_new_offsets = is_new_size || picture.channels != picture_.channels;
    picture_ = picture;
    next_ = 0;
    narrow_of_.fill(-1);
    if (is_new_size) {
        from_ = size_of(picture);
        place(from_.height, rows_);
        place(from_.width, columns_);
    }
    if (are_new_offsets)
        fill_column_taps();
}

void FixedPoint::place(uint32_t from, std::vector<Weighed> &axis) const
{
    const auto to = static_cast<uint32_t>(axis.size());
    const double inverse = static_cast<double>(to) / from, scale = 1.0 / inverse;
    const auto last = static_cast<int32_t>(from) - 1;
    for (uint32_t i = 0; i < to; i++) {
        Position position =
            kernel_ == Kernel::grown_area ? grown(i, scale, inverse) : between(i, scale);
        // Beyond the edge OpenCV blends the outermost row with itself but takes the outermost
        // column alone, which rounds differently.
        if (&axis == &columns_ && taps_ == 2 && (position.at < 0 || position.at >= last))
            position = {std::clamp(position.at, 0, last), 0.0f};
        axis[i] = {position.at - static_cast<int32_t>(taps_ / 2 - 1),
                   taps_ == 4 ? cubic_weights(position.fraction)
                              : linear_weights(position.fraction)};
    }
}

void FixedPoint::fill_column_taps()
{
    const auto last = static_cast<int32_t>(from_.width) - 1;
    const size_t row_bytes = size_t{from_.width} * picture_.channels;
    within_row_ = 0;
    for (uint32_t x = 0; x < to_.width; x++) {
        ColumnTap *const taps = &column_taps_[size_t{x} * taps_];
        for (uint32_t k = 0; k < taps_; k++) {
            const int32_t at = std::clamp(columns_[x].first + static_cast<int32_t>(k), 0, last);
            taps[k] = {static_cast<uint32_t>(at) * picture_.channels,
                       static_cast<float>(columns_[x].weights[k])};
        }
        if (taps[taps_ - 1].offset + channels_max <= row_bytes)
            within_row_ = x + 1;
    }
}

// One source row, resampled along its columns. Neighbouring output rows share most of them, so the
// last ones are kept.
const int32_t *FixedPoint::narrow_row(uint32_t source_row)
{
    const uint32_t slot = source_row % taps_; // rows needed together are neighbours
    int32_t *const out = narrow_[slot].data();
    if (narrow_of_[slot] == source_row)
        return out;
    narrow_of_[slot] = source_row;
    const uint8_t *const row = picture_.data + source_row * picture_.stride;
    const uint32_t channels = picture_.channels;
    const ColumnTap *const taps = column_taps_.data();
    if (taps_ == 2)
        narrow<2>(row, channels, taps, within_row_, out);
    else
        narrow<4>(row, channels, taps, within_row_, out);
    narrow_at_end(row, channels, taps + size_t{within_row_} * taps_, taps_, to_.width - within_row_,
                  out + size_t{within_row_} * channels);
    return out;
}

void FixedPoint::next_row(uint8_t *out)
{
    const Weighed &row = rows_[next_++];
    const auto last = static_cast<int32_t>(from_.height) - 1;
    std::array<const int32_t *, taps_max> rows{};
    for (uint32_t k = 0; k < taps_; k++)
        rows[k] = narrow_row(
            static_cast<uint32_t>(std::clamp(row.first + static_cast<int32_t>(k), 0, last)));
    const auto blend = taps_ == 2 ? blend_two : blend_four;
    blend(rows.data(), row.weights.data(), to_.width * size_t{picture_.channels}, out);
}

} // namespace vdna::picture
