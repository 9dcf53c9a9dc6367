// The named looks of the simulated route: season, weather and time of day.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "simulate/colour.hpp"

namespace vdna::simulate
{

// How a condition looks. Shares are 0..1.
struct Condition {
    std::string name;
    Colour sky_high, sky_low; // overhead and at the horizon; the latter is the haze's colour too
    float clouds;             // share of the sky
    Colour light;             // factor on every colour; 1 = a plain day
    float sun;                // strength of shading and shadows, share
    float shadow;             // metres of shadow per metre of height
    float haze_m;             // metres in which a colour loses 63 % to the haze
    Colour grass, leaves;
    float foliage; // share of the leaves that are on the trees
    float turned;  // share of the way to autumn's colours
    float blossom; // share of the bushes and trees that flower
    float litter;  // share of the ground under fallen leaves
    float snow;    // share of what faces the sky
    float wet;     // share of the sky that the path mirrors
    float rain;    // streaks, share of a downpour
    bool lamps;    // street lamps, windows and the robot's headlight are on
    float noise;   // standard deviation of the sensor, grey levels
};

// All conditions, in the order of the year and the day.
const std::vector<Condition> &conditions();

// Throws Error, listing the known ones, if there is no condition of that name.
const Condition &find_condition(const std::string &name);

// The same condition on another day: a little more or less of everything.
// variation: 0 = unchanged, 1 = as much as still goes by the same name
Condition on_another_day(const Condition &condition, float variation, uint64_t seed);

} // namespace vdna::simulate
