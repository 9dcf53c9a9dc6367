// How each kind of landmark looks under a condition.
#pragma once

#include "simulate/canvas.hpp"
#include "simulate/route.hpp"

namespace vdna::simulate
{

// Paint the landmark over what is behind it.
void paint_landmark(const Landmark &landmark, const Route &route, Canvas &canvas);

// Where a street lamp shines, metres above the ground.
inline float lamp_head(const Landmark &lamp)
{
    return lamp.height - .1f;
}

} // namespace vdna::simulate
