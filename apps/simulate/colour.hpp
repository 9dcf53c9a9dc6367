// Colours for the renderer.
#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

namespace vdna::simulate
{

using Colour = cv::Vec3f; // blue, green, red; 0..255, clamped only when drawn

inline Colour rgb(uint32_t hex)
{
    return {static_cast<float>(hex & 0xff), static_cast<float>(hex >> 8 & 0xff),
            static_cast<float>(hex >> 16 & 0xff)};
}

// share: 0 = all of a, 1 = all of b
inline Colour mix(const Colour &a, const Colour &b, float share)
{
    return a + (b - a) * share;
}

} // namespace vdna::simulate
