// The named looks of the simulated route: season, weather and time of day.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "simulate/colour.hpp"

namespace vdna::simulate
{

// The look of a condition. Shares are 0..1.
struct Condition {
    std::string name;
    Colour sky_high, sky_low; // overhead and at the horizon; the latter is also the haze's colour
    float clouds;             // share of the sky
    Colour light;             // factor on every colour; 1 = a plain day
    float sun;                // strength of shading and shadows, share
    float shadow;             // metres of shadow per metre of height
    float haze_m;             // distance at which haze replaces 63 % of a colour, metres
    Colour grass, leaves;
    float foliage; // share of leaves still on the trees
    float turned;  // progress towards autumn colours, share
    float blossom; // share of the bushes and trees that flower
    float litter;  // share of the ground under fallen leaves
    float snow;    // share of upward-facing surfaces
    float wet;     // share of the sky reflected by the path
    float rain;    // streaks, share of a downpour
    bool lamps;    // street lamps, windows and the robot's headlight are on
    float noise;   // standard deviation of the sensor, grey levels
};

// All conditions, in the order of the year and the day.
const std::vector<Condition> &conditions();

// Throws Error, listing all names, if there is no condition of this name.
const Condition &find_condition(const std::string &name);

// The same condition on another day: slightly more or less of everything.
// variation: 0 = unchanged, 1 = the most that still fits the name
Condition on_another_day(const Condition &condition, float variation, uint64_t seed);

} // namespace vdna::simulate
