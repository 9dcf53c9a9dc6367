#include "simulate/ground.hpp"

#include <algorithm>
#include <cmath>

namespace vdna::simulate
{

namespace
{

constexpr float wheel_track = .55f; // metres from the middle of the path

Colour surface_colour(Surface surface)
{
    static const Colour colours[] = {rgb(0x6d6e72), rgb(0xb5a88a), rgb(0xa39c94), rgb(0x7d6549)};
    return colours[static_cast<size_t>(surface)];
}

// True at the joints of a pattern that repeats every `period` metres.
bool on_joint(double metres, double period, double joint)
{
    return metres - period * std::floor(metres / period) < joint;
}

} // namespace

Colour Ground::lawn(float patches, float fine) const
{
    static const Colour straw = rgb(0x9a8a4c);
    return mix(condition_.grass, straw, .3f * std::clamp(.5f + patches, 0.f, 1.f)) *
           (1 + .22f * patches + .38f * fine);
}

Colour Ground::path(double along, double across, float fine) const
{
    const Surface surface = route_.surface(along);
    const Colour own = surface_colour(surface) * (1 + .16f * fine);
    if (surface == Surface::paving && (on_joint(along, .8, .06) || on_joint(across, .65, .06)))
        return own * .72f;
    if (surface == Surface::asphalt && std::abs(std::abs(across) - 1.1) < .06)
        return rgb(0xd8d8d0); // edge marking
    return own;
}

Colour Ground::colour(double along, double across, float detail) const
{
    const float patches = grain_.at(along / 31, across / 31);
    const float fine = grain_.at(along / 4.3, across / 4.3) * detail;
    const bool on_path = std::abs(across) + .12 * fine + .1 * patches < path_half_width;
    Colour own = on_path ? path(along, across, fine) : lawn(patches, fine);

    // Leaves and snow lie in patches, with fewer on the path.
    const float litter = condition_.litter - (on_path ? .25f : 0);
    if (condition_.litter > 0 && .5f + .9f * fine + .35f * patches < litter)
        own = fine > -.2f ? rgb(0xb5741f) : rgb(0x93501c);
    const bool driven = on_path && std::abs(std::abs(across) - wheel_track) < .22;
    const float swept = driven ? .55f : on_path ? .12f : 0;
    const float snow = condition_.snow > 0 ? 1.25f * condition_.snow - swept + .3f * patches : 0;
    return mix(own, rgb(0xeef1f6) * (.96f + .06f * fine), std::clamp(snow, 0.f, 1.f));
}

} // namespace vdna::simulate
