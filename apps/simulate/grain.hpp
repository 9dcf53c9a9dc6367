// Random texture for ground and clouds.
#pragma once

#include <opencv2/core.hpp>

namespace vdna::simulate
{

// One square tile of texture, which repeats seamlessly and is the same in every world.
class Grain
{
  public:
    Grain();

    // About -1..1; one tile per unit of x and y.
    float at(double x, double y) const;

  private:
    cv::Mat1f tile_;
};

} // namespace vdna::simulate
