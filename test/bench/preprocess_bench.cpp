// Times resizing and normalising, beside OpenCV's resize alone and beside both one after the other.
// Rounds go in turn, so that the ratios hold when the machine drifts.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <vector>

#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "preprocess.hpp"

using namespace vdna;

namespace
{

constexpr int rounds = 301;

double milliseconds(const std::function<void()> &work)
{
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
        .count();
}

double median(std::vector<double> values)
{
    std::nth_element(values.begin(), values.begin() + rounds / 2, values.end());
    return values[rounds / 2];
}

void compare(cv::Size from, Interpolation how, const char *name, int opencv_name)
{
    cv::Mat pixels(from, CV_8UC3), resized;
    cv::randu(pixels, 0, 256);
    const cv::Size to(224, 224);
    Preprocessor preprocessor(
        {"image", 224, 224, false, {123.675, 116.28, 103.53}, {58.395, 57.12, 57.375}, how});
    std::vector<float> out(3 * size_t(to.area()));
    const Picture picture{pixels, {2, 1, 0}};

    std::vector<double> ours, resize;
    for (int i = 0; i < rounds; i++) {
        ours.push_back(milliseconds([&] { preprocessor.run(picture, out.data()); }));
        resize.push_back(milliseconds([&] { cv::resize(pixels, resized, to, 0, 0, opencv_name); }));
    }
    std::printf("%4dx%-4d %-14s %8.3f %14.3f\n", from.width, from.height, name, median(ours),
                median(resize));
}

} // namespace

int main()
{
    cv::setNumThreads(1); // ours is in one thread, beside a network that has all
    std::printf("to 224x224, medians of %d interleaved rounds in ms, one thread\n", rounds);
    std::printf("%-9s %-14s %8s %14s\n", "from", "interpolation", "ours", "cv::resize only");
    for (const cv::Size from : {cv::Size(640, 480), cv::Size(1280, 720), cv::Size(224, 224)}) {
        compare(from, Interpolation::area, "area", cv::INTER_AREA);
        compare(from, Interpolation::linear, "linear", cv::INTER_LINEAR);
        compare(from, Interpolation::pillow_bicubic, "pillow_bicubic", cv::INTER_CUBIC);
    }
    return 0;
}
