#include "simulate/light.hpp"

#include <algorithm>
#include <cmath>

namespace vdna::simulate
{

Air Light::at(const cv::Point3f &seen) const
{
    static const Colour headlight = {.82f, .95f, 1}, lamp_light = {.5f, .8f, 1.05f};

    const float ahead = std::max(seen.z, .1f);
    const float clear = std::exp(-ahead / condition_.haze_m);
    Air air{condition_.light, condition_.sky_low * (1 - clear), clear};
    if (!condition_.lamps)
        return air;

    const float aside = seen.x / ahead / .45f, far = ahead / 5;
    air.gain += headlight * (.95f * std::exp(-aside * aside) / (1 + far * far));
    for (const cv::Point3f &lamp : lamps_) {
        const cv::Point3f way = lamp - seen;
        air.gain += lamp_light * (5 / (5 + way.dot(way)));
    }
    return air;
}

} // namespace vdna::simulate
