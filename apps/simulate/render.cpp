#include "simulate/render.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "simulate/canvas.hpp"
#include "simulate/chance.hpp"
#include "simulate/ground.hpp"
#include "simulate/landmark.hpp"

namespace vdna::simulate
{

namespace
{

constexpr double sight = 95;     // metres: nothing beyond is painted
constexpr double look_back = 15; // metres: long things may begin behind the camera
constexpr int noise_margin = 64; // pixels by which the noise shifts between pictures

cv::Vec3b pixel_of(const Colour &colour)
{
    return {cv::saturate_cast<uchar>(colour[0]), cv::saturate_cast<uchar>(colour[1]),
            cv::saturate_cast<uchar>(colour[2])};
}

std::vector<cv::Point3f> lamps_among(const std::vector<Landmark> &landmarks, const Route &route,
                                     const Camera &camera)
{
    std::vector<cv::Point3f> lamps;
    for (const Landmark &landmark : landmarks)
        if (landmark.kind == Kind::lamp)
            lamps.push_back(
                camera.see(route.at(landmark.along, landmark.across), lamp_head(landmark)));
    return lamps;
}

std::vector<cv::Point2d> disc(cv::Point2d centre, double radius)
{
    std::vector<cv::Point2d> rim;
    for (int i = 0; i < 12; i++) {
        const double angle = i * CV_PI / 6;
        rim.push_back(centre + radius * cv::Point2d(std::cos(angle), std::sin(angle)));
    }
    return rim;
}

} // namespace

Renderer::Renderer(const Route &route, const Condition &condition, cv::Size size)
    : route_(route), condition_(condition), size_(size),
      noise_(size + cv::Size(noise_margin, noise_margin))
{
    cv::RNG rng(1);
    rng.fill(noise_, cv::RNG::NORMAL, 0, 1);
}

void Renderer::paint_sky(cv::Mat3b &picture, const Camera &camera, float drift) const
{
    const Colour cloud = mix(condition_.sky_low, condition_.sky_high, .15f);
    const float gloom = condition_.clouds * condition_.clouds;
    for (int row = 0; row < size_.height / 2; row++) {
        const float up = 1 - static_cast<float>(row) / camera.horizon();
        const Colour clear = mix(condition_.sky_low, condition_.sky_high, std::sqrt(up));
        const double depth = 1 / (up + .3); // clouds are denser towards the horizon
        for (int column = 0; column < size_.width; column++) {
            const double right = (column - .5 * size_.width) / camera.focal();
            const double aside = (right - camera.pose().heading) * depth;
            const float thick = grain_.at(.16 * aside + drift, .16 * depth);
            const float cover = std::clamp(2 * (thick + 1.6f * condition_.clouds - .6f), 0.f, .9f);
            picture(row, column) = pixel_of(mix(clear, cloud * (1 - .25f * gloom * thick), cover));
        }
    }
}

void Renderer::paint_hills(cv::Mat3b &picture, const Camera &camera) const
{
    const Air air = Light(condition_, {}).at({0, 0, 130});
    const Colour summer = mix(condition_.leaves, rgb(0x4a5a44), .5f);
    const cv::Vec3b colour =
        pixel_of(air.through(mix(summer, rgb(0xc8ccd2), condition_.snow * .6f)));
    const int horizon = size_.height / 2;
    for (int column = 0; column < size_.width; column++) {
        const double right = (column - .5 * size_.width) / camera.focal();
        const float tall =
            camera.focal() * route_.skyline(camera.pose().heading - std::atan(right));
        for (int row = std::max(0, horizon - cvRound(tall)); row < horizon; row++)
            picture(row, column) = colour;
    }
}

// Darkness of the ground, 0..255, in the shadows of landmarks.
cv::Mat1b Renderer::shadows(const std::vector<Landmark> &landmarks, const Camera &camera) const
{
    cv::Mat1b mask(size_, uchar{0});
    const uchar dark = cv::saturate_cast<uchar>(255 * condition_.sun * .5f);
    const auto fill = [&](const std::vector<cv::Point2d> &corners) {
        std::vector<cv::Point3f> seen;
        for (const cv::Point2d &corner : corners)
            seen.push_back(camera.see(corner, 0));
        const auto pixels = outline(camera, seen);
        if (!pixels.empty())
            cv::fillConvexPoly(mask, pixels, dark, cv::LINE_8, pixel_shift);
    };
    for (const Landmark &landmark : landmarks) {
        // The sun is on the left and slightly behind the camera.
        const cv::Point2d fall = cv::Point2d(.3, -.9) * (condition_.shadow * landmark.height);
        const cv::Point2d foot = route_.at(landmark.along, landmark.across);
        if (landmark.length > 0) {
            const cv::Point2d end = route_.at(landmark.along + landmark.length, landmark.across);
            fill({foot, end, end + fall, foot + fall});
        } else {
            const cv::Point2d stem(.05 * landmark.height, 0), crown = foot + .6 * fall;
            const float leafy =
                landmark.kind <= Kind::bush ? .1f + .18f * condition_.foliage : .03f;
            fill({foot - stem, foot + stem, crown + stem, crown - stem});
            fill(disc(crown, leafy * landmark.height));
        }
    }
    return mask;
}

void Renderer::paint_ground(cv::Mat3b &picture, const Camera &camera, const Light &light,
                            const cv::Mat1b &shadows) const
{
    const Ground ground(route_, condition_, grain_);
    const Colour mirrored = mix(condition_.sky_low, condition_.sky_high, .4f);
    for (int row = size_.height / 2; row < size_.height; row++) {
        const float ahead =
            camera.focal() * Camera::height / (static_cast<float>(row) + .5f - camera.horizon());
        const float detail = 1 / (1 + ahead / 9);
        // Within one row of pixels, treat the route's line as straight.
        const cv::Point2d middle = camera.ground(0, ahead);
        const double line = route_.at(middle.x).y, slope = route_.slope(middle.x);
        for (int column = 0; column < size_.width; column++) {
            const float right =
                (static_cast<float>(column) - .5f * static_cast<float>(size_.width)) * ahead /
                camera.focal();
            const cv::Point2d at = camera.ground(right, ahead);
            const double across = at.y - line - slope * (at.x - middle.x);
            Colour own = ground.colour(route_.first_lap(at.x), across, detail);
            if (std::abs(across) < path_half_width)
                own = mix(own * (1 - .4f * condition_.wet), mirrored,
                          condition_.wet * ahead / (ahead + 8));
            own *= 1 - static_cast<float>(shadows(row, column)) / 255;
            picture(row, column) = pixel_of(light.at({right, Camera::height, ahead}).through(own));
        }
    }
}

void Renderer::paint_halos(cv::Mat3b &picture, const Camera &camera, const Light &light) const
{
    static const Colour glow = {90, 150, 190};
    for (const cv::Point3f &lamp : light.lamps()) {
        if (lamp.z < 1)
            continue;
        const cv::Point2f centre = camera.pixel(lamp);
        const float radius = camera.focal() * 1.1f / lamp.z;
        const cv::Rect box = cv::Rect(cv::Point(centre - cv::Point2f(radius, radius)),
                                      cv::Point(centre + cv::Point2f(radius, radius))) &
                             cv::Rect({}, size_);
        for (int row = box.y; row < box.br().y; row++)
            for (int column = box.x; column < box.br().x; column++) {
                const auto out = static_cast<float>(
                    cv::norm(cv::Point2f(cv::Point(column, row)) - centre) / radius);
                const float strength = std::max(0.f, 1 - out);
                picture(row, column) =
                    pixel_of(Colour(picture(row, column)) + glow * (strength * strength));
            }
    }
}

void Renderer::paint_rain(cv::Mat3b &picture, uint64_t seed) const
{
    cv::Mat3b streaks = picture.clone();
    const Colour drop = condition_.sky_low;
    Chance chance(seed);
    const int count = cvRound(condition_.rain * static_cast<float>(size_.width) * .6f);
    for (int i = 0; i < count; i++) {
        const cv::Point top(static_cast<int>(chance.below(static_cast<uint32_t>(size_.width))),
                            static_cast<int>(chance.below(static_cast<uint32_t>(size_.height))));
        const int length = cvRound(static_cast<float>(size_.height) * chance.between(.03f, .09f));
        cv::line(streaks, top, top + cv::Point(length / 6, length), drop, 1, cv::LINE_AA);
    }
    cv::addWeighted(streaks, .5, picture, .5, 0, picture);
}

// Lens and sensor: slight blur, exposure, noise.
void Renderer::expose(cv::Mat3b &picture, const Shot &shot) const
{
    Chance chance(shot.noise);
    const cv::Point corner(static_cast<int>(chance.below(noise_margin)),
                           static_cast<int>(chance.below(noise_margin)));
    cv::GaussianBlur(picture, picture, {3, 3}, .6);
    cv::Mat3f signal;
    picture.convertTo(signal, CV_32F, shot.exposure);
    cv::scaleAdd(noise_(cv::Rect(corner, size_)), condition_.noise, signal, signal);
    signal.convertTo(picture, CV_8U);
}

cv::Mat3b Renderer::render(const Shot &shot) const
{
    const Camera camera(shot.pose, size_);
    const auto landmarks = route_.landmarks(shot.pose.x - look_back, shot.pose.x + sight);
    const Light light(condition_, condition_.lamps ? lamps_among(landmarks, route_, camera)
                                                   : std::vector<cv::Point3f>());
    cv::Mat3b picture(size_);
    paint_sky(picture, camera, shot.drift);
    paint_hills(picture, camera);
    paint_ground(picture, camera, light, shadows(landmarks, camera));
    Canvas canvas(picture, camera, light);
    for (const Landmark &landmark : landmarks)
        paint_landmark(landmark, route_, canvas);
    paint_halos(picture, camera, light);
    if (condition_.rain > 0)
        paint_rain(picture, shot.noise);
    expose(picture, shot);
    return picture;
}

} // namespace vdna::simulate
