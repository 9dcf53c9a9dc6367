// The look of each kind of landmark under a condition.
#pragma once

#include "simulate/canvas.hpp"
#include "simulate/route.hpp"

namespace vdna::simulate
{

// Paint the landmark over the background.
void paint_landmark(const Landmark &landmark, const Route &route, Canvas &canvas);

// Height of a street lamp's light, metres above the ground.
inline float lamp_head(const Landmark &lamp)
{
    return lamp.height - .1f;
}

} // namespace vdna::simulate
