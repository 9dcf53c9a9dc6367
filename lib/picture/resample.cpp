#include "resample.hpp"

#include "area_means.hpp"
#include "block_means.hpp"
#include "fixed_point.hpp"
#include "pillow_bicubic.hpp"

namespace vdna::picture
{

Resampler::Resampler(Interpolation interpolation, Size to) : interpolation_(interpolation), to_(to)
{
    switch (interpolation) {
    case Interpolation::area:
        usual_ = std::make_unique<AreaMeans>(to);
        whole_ = std::make_unique<BlockMeans>(to);
        growing_ = std::make_unique<FixedPoint>(FixedPoint::Kernel::grown_area, to);
        break;
    case Interpolation::linear:
        usual_ = std::make_unique<FixedPoint>(FixedPoint::Kernel::linear, to);
        whole_ = std::make_unique<BlockMeans>(to);
        break;
    case Interpolation::cubic:
        usual_ = std::make_unique<FixedPoint>(FixedPoint::Kernel::cubic, to);
        break;
    case Interpolation::pillow_bicubic:
        usual_ = std::make_unique<PillowBicubic>(to);
        break;
    }
}

Method &Resampler::method_for(Size from) const
{
    if (interpolation_ == Interpolation::area) {
        if (from.width < to_.width || from.height < to_.height)
            return *growing_;
        if (from.width % to_.width == 0 && from.height % to_.height == 0)
            return *whole_;
    }
    // OpenCV halves pictures by area even if linear is asked for.
    if (interpolation_ == Interpolation::linear && from.width == 2 * to_.width &&
        from.height == 2 * to_.height)
        return *whole_;
    return *usual_;
}

void Resampler::begin(const vdna_pixels &picture)
{
    method_ = &method_for(size_of(picture));
    method_->begin(picture);
}

} // namespace vdna::picture
