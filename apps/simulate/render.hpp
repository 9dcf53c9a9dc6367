// Renders a picture of a place on the route under a condition.
#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

#include "simulate/camera.hpp"
#include "simulate/condition.hpp"
#include "simulate/grain.hpp"
#include "simulate/light.hpp"
#include "simulate/route.hpp"

namespace vdna::simulate
{

// The camera's pose and settings for one picture.
struct Shot {
    Pose pose;
    float exposure; // factor; 1 = that of the condition
    float drift;    // of the clouds, in tiles of their texture
    uint64_t noise; // seed of the sensor's noise and of the rain
};

class Renderer
{
  public:
    // size: at least 16x16
    Renderer(const Route &route, const Condition &condition, cv::Size size);

    // The same arguments give the same pixels (with the same version of OpenCV).
    cv::Mat3b render(const Shot &shot) const;

  private:
    void paint_sky(cv::Mat3b &picture, const Camera &camera, float drift) const;
    void paint_hills(cv::Mat3b &picture, const Camera &camera) const;
    void paint_ground(cv::Mat3b &picture, const Camera &camera, const Light &light,
                      const cv::Mat1b &shadows) const;
    cv::Mat1b shadows(const std::vector<Landmark> &landmarks, const Camera &camera) const;
    void paint_halos(cv::Mat3b &picture, const Camera &camera, const Light &light) const;
    void paint_rain(cv::Mat3b &picture, uint64_t seed) const;
    void expose(cv::Mat3b &picture, const Shot &shot) const;

    Route route_;
    Condition condition_;
    cv::Size size_;
    Grain grain_;
    cv::Mat3f noise_; // normally distributed, larger than the picture
};

} // namespace vdna::simulate
