// What reaches the camera of a colour: daylight, lamps, headlight and haze.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "simulate/colour.hpp"
#include "simulate/condition.hpp"

namespace vdna::simulate
{

// The light at one point, and the haze between it and the camera.
struct Air {
    Colour gain; // factor on a colour there
    Colour haze; // what the haze adds
    float clear; // share that passes the haze

    Colour through(const Colour &colour) const { return colour.mul(gain) * clear + haze; }
    // The same for what shines by itself.
    Colour glowing(const Colour &colour) const { return colour * clear + haze; }
};

class Light
{
  public:
    // lamps: where the street lamps shine, as the camera sees them
    Light(const Condition &condition, std::vector<cv::Point3f> lamps)
        : condition_(condition), lamps_(std::move(lamps))
    {
    }

    const Condition &condition() const { return condition_; }
    const std::vector<cv::Point3f> &lamps() const { return lamps_; }
    Air at(const cv::Point3f &seen) const;

  private:
    const Condition &condition_;
    std::vector<cv::Point3f> lamps_;
};

} // namespace vdna::simulate
