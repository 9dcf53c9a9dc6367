// The light of a scene and its effect on colours: daylight, lamps, headlight and haze.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "simulate/colour.hpp"
#include "simulate/condition.hpp"

namespace vdna::simulate
{

// The light at one point, and the haze between it and the camera.
struct Air {
    Colour gain; // factor on a colour at the point
    Colour haze; // colour added by the haze
    float clear; // share of light that passes the haze

    Colour through(const Colour &colour) const { return colour.mul(gain) * clear + haze; }
    // The same for a luminous colour.
    Colour glowing(const Colour &colour) const { return colour * clear + haze; }
};

class Light
{
  public:
    // lamps: positions of the street lamps, as seen by the camera
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
