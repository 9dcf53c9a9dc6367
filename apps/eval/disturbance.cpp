#include "eval/disturbance.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <vdna/cpp/error.hpp>

namespace vdna::eval
{

namespace
{

// Each number of each pixel by itself, below `levels`.
cv::Mat random_levels(const cv::Mat &scene, std::mt19937 &random, uint32_t levels)
{
    cv::Mat picture(scene.size(), CV_8UC3);
    for (int y = 0; y < picture.rows; y++)
        for (int i = 0; i < 3 * picture.cols; i++)
            picture.ptr(y)[i] = static_cast<uint8_t>(random() % levels);
    return picture;
}

cv::Mat black(const cv::Mat &scene, std::mt19937 &)
{
    return {scene.size(), CV_8UC3, cv::Scalar(0, 0, 0)};
}

cv::Mat white(const cv::Mat &scene, std::mt19937 &)
{
    return {scene.size(), CV_8UC3, cv::Scalar(255, 255, 255)};
}

cv::Mat lens_cap(const cv::Mat &scene, std::mt19937 &random)
{
    return random_levels(scene, random, 16);
}

cv::Mat noise(const cv::Mat &scene, std::mt19937 &random)
{
    return random_levels(scene, random, 256);
}

cv::Mat blur(const cv::Mat &scene, std::mt19937 &)
{
    cv::Mat picture;
    cv::GaussianBlur(scene, picture, {0, 0}, scene.cols / 20.0);
    return picture;
}

} // namespace

const std::vector<Disturbance> disturbances = {
    {"black", false, 1, black},  {"white", false, 1, white}, {"lens cap", false, 20, lens_cap},
    {"noise", false, 20, noise}, {"blur", true, 20, blur},
};

cv::Mat decoded(const std::vector<uint8_t> &picture, const std::string &name)
{
    cv::Mat scene;
    try {
        scene = cv::imdecode(picture, cv::IMREAD_COLOR);
    } catch (const cv::Exception &failure) {
        throw Error(name + ": OpenCV: " + failure.err);
    }
    if (scene.empty())
        throw Error(name + ": cannot be decoded");
    return scene;
}

} // namespace vdna::eval
