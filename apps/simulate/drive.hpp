// One drive along the route: the pose of the robot and the camera's settings for each frame.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simulate/render.hpp"
#include "simulate/route.hpp"

namespace vdna::simulate
{

struct DriveConfig {
    double start_m = 0;  // along the route
    double step_m = .5;  // along the route from frame to frame, >= 0
    double rate_hz = 10; // frames per second, > 0
    float variation = 0; // 0..1: deviation from the line, the speed and the exposure
    uint64_t seed = 1;   // of this drive's random numbers
};

class Drive
{
  public:
    Drive(const Route &route, const DriveConfig &config);

    Shot shot(size_t frame) const;
    cv::Point2d position(size_t frame) const; // that of Route::position()
    int64_t utime(size_t frame) const;        // microseconds since the drive began

  private:
    double driven(size_t frame) const; // along the route, all laps
    double swing(double along) const;  // radians
    double across(double along) const;

    Route route_;
    DriveConfig config_;
    double bias_m_, sway_m_; // offset from the route's line: constant and periodic part
    double speed_;           // factor
    float exposure_, drift_;
    double phase_;
};

} // namespace vdna::simulate
