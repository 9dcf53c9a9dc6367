// The picture being painted, and its drawing operations.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "simulate/camera.hpp"
#include "simulate/light.hpp"

namespace vdna::simulate
{

constexpr int pixel_shift = 4; // fractional bits of pixels in OpenCV's drawing functions

// The part of a flat convex face in front of the camera, in pixels; empty if there is none.
std::vector<cv::Point> outline(const Camera &camera, const std::vector<cv::Point3f> &corners);

// All coordinates are as seen by the camera (see camera.hpp); shapes may be partly behind it.
class Canvas
{
  public:
    Canvas(cv::Mat3b picture, const Camera &camera, const Light &light)
        : picture_(std::move(picture)), camera_(camera), light_(light)
    {
    }

    const Camera &camera() const { return camera_; }
    const Light &light() const { return light_; }
    const Condition &condition() const { return light_.condition(); }
    cv::Mat3b &picture() { return picture_; }

    // A flat convex face, lit by the light at its middle.
    void face(const std::vector<cv::Point3f> &corners, const Colour &colour);
    // The same, for a luminous face.
    void glowing_face(const std::vector<cv::Point3f> &corners, const Colour &colour);
    // width: metres
    void line(const cv::Point3f &from, const cv::Point3f &to, float width, const Colour &colour);

  private:
    cv::Mat3b picture_;
    const Camera &camera_;
    const Light &light_;
};

// An upright object on the ground that faces the camera: painted in metres right of and above its
// foot, under one light.
class Stand
{
  public:
    Stand(Canvas &canvas, const cv::Point3f &foot);

    Canvas &canvas() { return canvas_; }
    const Condition &condition() const { return canvas_.condition(); }
    float pixels(float metres) const { return metres * scale_; }

    void disc(cv::Point2f centre, float radius, const Colour &colour);
    void glowing_disc(cv::Point2f centre, float radius, const Colour &colour);
    void polygon(const std::vector<cv::Point2f> &corners, const Colour &colour);
    void rectangle(cv::Point2f low, cv::Point2f high, const Colour &colour);
    void line(cv::Point2f from, cv::Point2f to, float width, const Colour &colour);

  private:
    cv::Point2f pixel(cv::Point2f at) const { return foot_ + cv::Point2f(at.x, -at.y) * scale_; }
    void fill_disc(cv::Point2f centre, float radius, const Colour &colour);

    Canvas &canvas_;
    cv::Point2f foot_; // a pixel
    float scale_;      // pixels per metre
    Air air_;
};

} // namespace vdna::simulate
