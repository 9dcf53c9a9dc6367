#include "preprocess.hpp"

#include <opencv2/imgproc.hpp>

namespace vdna::backbone
{

namespace
{

int opencv_name(Interpolation interpolation)
{
    switch (interpolation) {
    case Interpolation::linear:
        return cv::INTER_LINEAR;
    case Interpolation::cubic:
        return cv::INTER_CUBIC;
    default:
        return cv::INTER_AREA;
    }
}

// Where both ratios are whole OpenCV is quick, and rounds its own way. Where a side grows its area
// is another thing.
bool is_left_to_opencv(cv::Size from, cv::Size to)
{
    return (from.width % to.width == 0 && from.height % to.height == 0) || from.width < to.width ||
           from.height < to.height;
}

} // namespace

Preprocessor::Preprocessor(const Input &input)
    : size_(static_cast<int>(input.width), static_cast<int>(input.height)),
      interpolation_(input.interpolation),
      order_(input.bgr ? std::array<size_t, 3>{2, 1, 0} : std::array<size_t, 3>{0, 1, 2}),
      tables_(), area_(size_)
{
    row_.reserve(size_t{input.width} * Picture::most_channels);
    for (size_t c = 0; c < tables_.size(); c++)
        for (size_t level = 0; level < tables_[c].size(); level++)
            tables_[c][level] =
                static_cast<float>((static_cast<double>(level) - input.mean[c]) / input.std[c]);
}

void Preprocessor::prepare(cv::Size from)
{
    if (from == from_)
        return;
    from_ = from;
    by_area_ = interpolation_ == Interpolation::area && !is_left_to_opencv(from, size_);
    if (by_area_)
        area_.prepare(from);
    else if (interpolation_ == Interpolation::pillow_bicubic)
        pillow_.emplace(from, size_);
}

void Preprocessor::run(const Picture &picture, float *out)
{
    prepare(picture.pixels.size());
    if (by_area_) {
        row_.resize(static_cast<size_t>(size_.width * picture.pixels.channels()));
        for (int y = 0; y < size_.height; y++) {
            area_.row(picture.pixels, y, row_.data());
            normalise_row(row_.data(), picture, y, out);
        }
        return;
    }
    if (pillow_)
        pillow_->run(picture.pixels, resized_);
    else
        cv::resize(picture.pixels, resized_, size_, 0, 0, opencv_name(interpolation_));
    for (int y = 0; y < size_.height; y++)
        normalise_row(resized_.ptr(y), picture, y, out);
}

// Row y of all channels of the network, from 8-bit pixels.
void Preprocessor::normalise_row(const uint8_t *row, const Picture &picture, int y,
                                 float *out) const
{
    const auto width = static_cast<size_t>(size_.width), height = static_cast<size_t>(size_.height);
    const auto channels = static_cast<size_t>(picture.pixels.channels());
    for (size_t c = 0; c < tables_.size(); c++) {
        const Table &table = tables_[c];
        const uint8_t *level = row + picture.rgb[order_[c]];
        float *to = out + (c * height + static_cast<size_t>(y)) * width;
        for (size_t x = 0; x < width; x++)
            to[x] = table[level[x * channels]];
    }
}

} // namespace vdna::backbone
