#include "simulate/drive.hpp"

#include <cmath>

#include "simulate/chance.hpp"

namespace vdna::simulate
{

namespace
{

constexpr double sway_length = 23; // metres of route per period

} // namespace

Drive::Drive(const Route &route, const DriveConfig &config) : route_(route), config_(config)
{
    Chance chance(config.seed);
    const float variation = config.variation;
    bias_m_ = variation * chance.between(-.35f, .35f);
    sway_m_ = variation * chance.between(.1f, .3f);
    speed_ = 1 + variation * chance.between(-.12f, .12f);
    exposure_ = 1 + variation * chance.between(-.15f, .15f);
    drift_ = chance.unit();
    phase_ = chance.between(0, 2 * static_cast<float>(CV_PI));
}

double Drive::driven(size_t frame) const
{
    return config_.start_m + static_cast<double>(frame) * config_.step_m * speed_;
}

double Drive::swing(double along) const
{
    return 2 * CV_PI * along / sway_length + phase_;
}

double Drive::across(double along) const
{
    return bias_m_ + sway_m_ * std::sin(swing(along));
}

cv::Point2d Drive::position(size_t frame) const
{
    return route_.position(driven(frame), across(driven(frame)));
}

Shot Drive::shot(size_t frame) const
{
    const double along = driven(frame), here = route_.first_lap(along);
    const cv::Point2d at = route_.at(here, across(along));
    const double slope =
        route_.slope(here) + sway_m_ * 2 * CV_PI / sway_length * std::cos(swing(along));
    // The camera's exposure control overshoots slightly when the scene changes.
    const auto hunting = static_cast<float>(.04 * std::sin(along / 3 + phase_));
    return {{at.x, at.y, std::atan(slope)},
            exposure_ + config_.variation * hunting,
            drift_,
            seed_of_part(config_.seed, frame)};
}

int64_t Drive::utime(size_t frame) const
{
    return std::llround(static_cast<double>(frame) * 1e6 / config_.rate_hz);
}

} // namespace vdna::simulate
