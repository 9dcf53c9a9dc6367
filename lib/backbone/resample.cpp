#include "resample.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "decode.hpp"

namespace vdna::backbone
{

namespace
{

constexpr size_t lanes = Picture::most_channels; // sums of a pixel's channels
constexpr int precision_bits = 22;               // of Pillow's weights
constexpr double bicubic_support = 2.0;

// Keys' cubic convolution with a = -0.5.
double bicubic(double x)
{
    constexpr double a = -0.5;
    x = std::fabs(x);
    if (x < 1.0)
        return ((a + 2.0) * x - (a + 3.0)) * x * x + 1.0;
    return x < 2.0 ? (((x - 5.0) * x + 8.0) * x - 4.0) * a : 0.0;
}

int32_t fixed_point(double weight)
{
    const double scaled = weight * (1 << precision_bits);
    return static_cast<int32_t>(scaled < 0 ? scaled - 0.5 : scaled + 0.5);
}

uint8_t level_of(int32_t sum)
{
    return static_cast<uint8_t>(std::clamp(sum >> precision_bits, 0, 255));
}

// To the nearest, halves to the even level, without a call.
uint8_t level_of(float value)
{
    constexpr float shift = 12582912.0f; // 1.5 * 2^23: above it floats are whole
    return static_cast<uint8_t>(value + shift - shift);
}

// sums += weight * row
template <class Weight>
void add_row(const uint8_t *row, Weight weight, size_t count, Weight *sums)
{
    for (size_t i = 0; i < count; i++)
        sums[i] += weight * static_cast<Weight>(row[i]);
}

// Sum of the rows of a span.
template <class Weight>
void add_rows(const cv::Mat &picture, const Taps<Weight> &taps, int y, std::vector<Weight> &sums)
{
    const typename Taps<Weight>::Span &span = taps.spans[static_cast<size_t>(y)];
    const auto count = static_cast<size_t>(picture.cols) * static_cast<size_t>(picture.channels());
    for (int i = 0; i < span.count; i++)
        add_row(picture.ptr(span.first + i), taps.weights[span.weights_at + static_cast<size_t>(i)],
                count, sums.data());
}

void narrow_row(const uint8_t *row, const Taps<int32_t> &taps, int channels, uint8_t *out)
{
    for (const Taps<int32_t>::Span &span : taps.spans)
        for (int c = 0; c < channels; c++) {
            int32_t sum = 1 << (precision_bits - 1);
            const uint8_t *pixel = row + span.first * channels + c;
            for (int i = 0; i < span.count; i++, pixel += channels)
                sum += *pixel * taps.weights[span.weights_at + static_cast<size_t>(i)];
            *out++ = level_of(sum);
        }
}

// Weights of the part of each source pixel that an output pixel covers. from >= to.
void fill_area_taps(int from, int to, Taps<float> &taps)
{
    taps.spans.clear();
    taps.weights.clear();
    const double scale = static_cast<double>(from) / to;
    for (int i = 0; i < to; i++) {
        const double begin = i * scale, end = std::min(begin + scale, static_cast<double>(from));
        const int first = static_cast<int>(begin);
        const int last = std::min(static_cast<int>(std::ceil(end)), from);
        taps.spans.push_back({first, last - first, taps.weights.size()});
        for (int pixel = first; pixel < last; pixel++) {
            const double covered = std::min(end, pixel + 1.0) - std::max<double>(begin, pixel);
            taps.weights.push_back(static_cast<float>(covered / (end - begin)));
        }
    }
}

// Room for any picture: an output pixel shares at most its first source pixel with the one before.
void reserve_area_taps(int to, Taps<float> &taps)
{
    const auto pixels = static_cast<size_t>(to);
    taps.spans.reserve(pixels);
    taps.weights.reserve(VDNA_IMAGE_SIDE_MAX + pixels);
}

} // namespace

Taps<int32_t> pillow_bicubic_taps(int from, int to)
{
    Taps<int32_t> taps;
    const double scale = static_cast<double>(from) / to;
    const double widening = std::max(scale, 1.0), support = bicubic_support * widening;
    for (int i = 0; i < to; i++) {
        const double centre = (i + 0.5) * scale;
        const int first = std::max(static_cast<int>(centre - support + 0.5), 0);
        const int last = std::min(static_cast<int>(centre + support + 0.5), from);
        std::vector<double> weights;
        double total = 0.0;
        for (int pixel = first; pixel < last; pixel++) {
            weights.push_back(bicubic((pixel - centre + 0.5) * (1.0 / widening)));
            total += weights.back();
        }
        taps.spans.push_back({first, last - first, taps.weights.size()});
        for (const double weight : weights)
            taps.weights.push_back(fixed_point(weight / total));
    }
    return taps;
}

AreaResampler::AreaResampler(cv::Size to) : to_(to)
{
    reserve_area_taps(to.height, rows_);
    reserve_area_taps(to.width, columns_);
    sums_.reserve((VDNA_IMAGE_SIDE_MAX + 1) * lanes);
}

void AreaResampler::prepare(cv::Size from)
{
    fill_area_taps(from.height, to_.height, rows_);
    fill_area_taps(from.width, to_.width, columns_);
}

void AreaResampler::row(const cv::Mat &picture, int y, uint8_t *out)
{
    // As many numbers are added at once, whatever the channels: those beyond a pixel's are not
    // used.
    typedef float Four __attribute__((vector_size(lanes * sizeof(float))));
    const auto channels = static_cast<size_t>(picture.channels());
    sums_.assign(static_cast<size_t>(picture.cols) * channels + lanes, 0.0f);
    add_rows(picture, rows_, y, sums_);

    for (const Taps<float>::Span &span : columns_.spans) {
        const float *pixel = &sums_[static_cast<size_t>(span.first) * channels];
        Four sum = {};
        for (int i = 0; i < span.count; i++, pixel += channels) {
            Four four;
            std::memcpy(&four, pixel, sizeof four);
            sum += four * columns_.weights[span.weights_at + static_cast<size_t>(i)];
        }
        for (size_t c = 0; c < channels; c++)
            *out++ = level_of(sum[c]);
    }
}

PillowResampler::PillowResampler(cv::Size from, cv::Size to)
    : rows_(pillow_bicubic_taps(from.height, to.height)),
      columns_(pillow_bicubic_taps(from.width, to.width))
{
}

void PillowResampler::run(const cv::Mat &picture, cv::Mat &out)
{
    const int width = static_cast<int>(columns_.spans.size());
    const int height = static_cast<int>(rows_.spans.size());
    narrow_.create(picture.rows, width, picture.type());
    for (int y = 0; y < picture.rows; y++)
        narrow_row(picture.ptr(y), columns_, picture.channels(), narrow_.ptr(y));

    out.create(height, width, picture.type());
    const auto count = static_cast<size_t>(width) * static_cast<size_t>(picture.channels());
    for (int y = 0; y < height; y++) {
        sums_.assign(count, 1 << (precision_bits - 1));
        add_rows(narrow_, rows_, y, sums_);
        std::transform(sums_.begin(), sums_.end(), out.ptr(y),
                       [](int32_t sum) { return level_of(sum); });
    }
}

} // namespace vdna::backbone
