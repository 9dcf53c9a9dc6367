#include "preprocess.hpp"

#include <opencv2/imgproc.hpp>

namespace vdna
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

} // namespace

Preprocessor::Preprocessor(const Input &input)
    : size_(static_cast<int>(input.width), static_cast<int>(input.height)),
      interpolation_(opencv_name(input.interpolation)),
      order_(input.bgr ? std::array<size_t, 3>{2, 1, 0} : std::array<size_t, 3>{0, 1, 2}), tables_()
{
    for (size_t c = 0; c < tables_.size(); c++)
        for (size_t level = 0; level < tables_[c].size(); level++)
            tables_[c][level] =
                static_cast<float>((static_cast<double>(level) - input.mean[c]) / input.std[c]);
}

void Preprocessor::run(const Picture &picture, float *out)
{
    cv::resize(picture.pixels, resized_, size_, 0, 0, interpolation_);

    const auto channels = static_cast<size_t>(resized_.channels());
    for (size_t c = 0; c < tables_.size(); c++) {
        const Table &table = tables_[c];
        const auto offset = static_cast<size_t>(picture.rgb[order_[c]]);
        for (int y = 0; y < size_.height; y++) {
            const uint8_t *row = resized_.ptr(y) + offset;
            for (int x = 0; x < size_.width; x++)
                *out++ = table[row[static_cast<size_t>(x) * channels]];
        }
    }
}

} // namespace vdna
