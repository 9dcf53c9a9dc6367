// The ground of the route: path, lawn, fallen leaves and snow.
#pragma once

#include "simulate/colour.hpp"
#include "simulate/condition.hpp"
#include "simulate/grain.hpp"
#include "simulate/route.hpp"

namespace vdna::simulate
{

class Ground
{
  public:
    // Borrows all three.
    Ground(const Route &route, const Condition &condition, const Grain &grain)
        : route_(route), condition_(condition), grain_(grain)
    {
    }

    // The colour at a place, before light and haze.
    // along, across: the place on the route; detail: 0..1, less at a distance
    Colour colour(double along, double across, float detail) const;

  private:
    Colour lawn(float patches, float fine) const;
    Colour path(double along, double across, float fine) const;

    const Route &route_;
    const Condition &condition_;
    const Grain &grain_;
};

} // namespace vdna::simulate
