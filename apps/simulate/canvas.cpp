#include "simulate/canvas.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace vdna::simulate
{

namespace
{

constexpr float near_plane = .3f; // metres: nothing closer is painted

// OpenCV's drawing functions take integers, so clamp points far outside the picture.
cv::Point fixed(cv::Point2f pixel)
{
    constexpr float limit = 1 << 14;
    return {cvRound(std::clamp(pixel.x, -limit, limit) * (1 << pixel_shift)),
            cvRound(std::clamp(pixel.y, -limit, limit) * (1 << pixel_shift))};
}

// The part of a convex face in front of the camera.
std::vector<cv::Point3f> before_camera(const std::vector<cv::Point3f> &corners)
{
    std::vector<cv::Point3f> kept;
    for (size_t i = 0; i < corners.size(); i++) {
        const cv::Point3f &a = corners[i], &b = corners[(i + 1) % corners.size()];
        if (a.z >= near_plane)
            kept.push_back(a);
        if ((a.z >= near_plane) != (b.z >= near_plane))
            kept.push_back(a + (b - a) * ((near_plane - a.z) / (b.z - a.z)));
    }
    return kept;
}

cv::Point3f middle(const std::vector<cv::Point3f> &points)
{
    cv::Point3f sum;
    for (const cv::Point3f &point : points)
        sum += point;
    return sum * (1 / static_cast<float>(points.size()));
}

// A stroke with a width is a thin rectangle; below one pixel, it fades instead of flickering.
void stroke(cv::Mat3b &picture, cv::Point2f from, cv::Point2f to, float width, const Colour &colour)
{
    if (width < 1.5f) {
        cv::line(picture, fixed(from), fixed(to), colour, 1, cv::LINE_AA, pixel_shift);
        return;
    }
    const cv::Point2f along = to - from;
    const auto length = static_cast<float>(std::max(1e-3, cv::norm(along)));
    const cv::Point2f side = cv::Point2f(-along.y, along.x) * (width / 2 / length);
    const cv::Point corners[] = {fixed(from + side), fixed(to + side), fixed(to - side),
                                 fixed(from - side)};
    cv::fillConvexPoly(picture, corners, 4, colour, cv::LINE_AA, pixel_shift);
}

} // namespace

std::vector<cv::Point> outline(const Camera &camera, const std::vector<cv::Point3f> &corners)
{
    std::vector<cv::Point> pixels;
    for (const cv::Point3f &corner : before_camera(corners))
        pixels.push_back(fixed(camera.pixel(corner)));
    return pixels;
}

void Canvas::face(const std::vector<cv::Point3f> &corners, const Colour &colour)
{
    const auto pixels = outline(camera_, corners);
    if (!pixels.empty())
        cv::fillConvexPoly(picture_, pixels, light_.at(middle(corners)).through(colour),
                           cv::LINE_AA, pixel_shift);
}

void Canvas::glowing_face(const std::vector<cv::Point3f> &corners, const Colour &colour)
{
    const auto pixels = outline(camera_, corners);
    if (!pixels.empty())
        cv::fillConvexPoly(picture_, pixels, light_.at(middle(corners)).glowing(colour),
                           cv::LINE_AA, pixel_shift);
}

void Canvas::line(const cv::Point3f &from, const cv::Point3f &to, float width, const Colour &colour)
{
    const auto visible = before_camera({from, to});
    if (visible.size() < 2)
        return;
    const cv::Point3f centre = middle(visible);
    stroke(picture_, camera_.pixel(visible[0]), camera_.pixel(visible[1]),
           width * camera_.focal() / centre.z, light_.at(centre).through(colour));
}

Stand::Stand(Canvas &canvas, const cv::Point3f &foot)
    : canvas_(canvas), foot_(canvas.camera().pixel(foot)), scale_(canvas.camera().focal() / foot.z),
      air_(canvas.light().at(foot))
{
}

void Stand::fill_disc(cv::Point2f centre, float radius, const Colour &colour)
{
    cv::circle(canvas_.picture(), fixed(pixel(centre)) / (1 << pixel_shift),
               std::max(1, cvRound(radius * scale_)), colour, cv::FILLED);
}

void Stand::disc(cv::Point2f centre, float radius, const Colour &colour)
{
    fill_disc(centre, radius, air_.through(colour));
}

void Stand::glowing_disc(cv::Point2f centre, float radius, const Colour &colour)
{
    fill_disc(centre, radius, air_.glowing(colour));
}

void Stand::polygon(const std::vector<cv::Point2f> &corners, const Colour &colour)
{
    std::vector<cv::Point> pixels;
    for (const cv::Point2f &corner : corners)
        pixels.push_back(fixed(pixel(corner)));
    cv::fillConvexPoly(canvas_.picture(), pixels, air_.through(colour), cv::LINE_AA, pixel_shift);
}

void Stand::rectangle(cv::Point2f low, cv::Point2f high, const Colour &colour)
{
    polygon({low, {high.x, low.y}, high, {low.x, high.y}}, colour);
}

void Stand::line(cv::Point2f from, cv::Point2f to, float width, const Colour &colour)
{
    stroke(canvas_.picture(), pixel(from), pixel(to), width * scale_, air_.through(colour));
}

} // namespace vdna::simulate
