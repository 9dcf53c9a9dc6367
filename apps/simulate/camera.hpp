// The pose of the robot, and the projection of its camera.
#pragma once

#include <cmath>

#include <opencv2/core.hpp>

namespace vdna::simulate
{

struct Pose {
    double x, y;    // metres in the world
    double heading; // radians, 0 along x, positive to the left
};

// A pinhole camera one metre above the ground, looking level ahead.
// "Seen" points are in metres: x to the right, y down, z ahead of the camera.
class Camera
{
  public:
    Camera(const Pose &pose, cv::Size size)
        : pose_(pose), size_(size), focal_(.8f * static_cast<float>(size.width)),
          ahead_(std::cos(pose.heading), std::sin(pose.heading))
    {
    }

    const Pose &pose() const { return pose_; }
    cv::Size size() const { return size_; }
    float focal() const { return focal_; } // pixels per metre at one metre

    float horizon() const { return .5f * static_cast<float>(size_.height); } // a picture row

    // up: metres above the ground
    cv::Point3f see(cv::Point2d world, double up) const
    {
        const cv::Point2d offset(world.x - pose_.x, world.y - pose_.y);
        return cv::Point3f(static_cast<float>(offset.x * ahead_.y - offset.y * ahead_.x),
                           static_cast<float>(height - up), static_cast<float>(offset.dot(ahead_)));
    }

    // The point on the ground at this distance to the right and ahead.
    cv::Point2d ground(double right, double ahead) const
    {
        return {pose_.x + ahead * ahead_.x + right * ahead_.y,
                pose_.y + ahead * ahead_.y - right * ahead_.x};
    }

    // seen.z must be positive.
    cv::Point2f pixel(const cv::Point3f &seen) const
    {
        return {.5f * static_cast<float>(size_.width) + focal_ * seen.x / seen.z,
                horizon() + focal_ * seen.y / seen.z};
    }

    static constexpr float height = 1;

  private:
    Pose pose_;
    cv::Size size_;
    float focal_;
    cv::Point2d ahead_;
};

} // namespace vdna::simulate
