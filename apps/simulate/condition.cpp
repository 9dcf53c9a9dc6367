#include "simulate/condition.hpp"

#include <algorithm>

#include <vdna/cpp/error.hpp>

#include "program/exit_code.hpp"
#include "simulate/chance.hpp"

namespace vdna::simulate
{

namespace
{

Condition spring()
{
    Condition look;
    look.name = "spring";
    look.sky_high = rgb(0x6f9fd8);
    look.sky_low = rgb(0xd4e2ec);
    look.clouds = .35f;
    look.light = {1, 1, 1};
    look.sun = .7f;
    look.shadow = .9f;
    look.haze_m = 160;
    look.grass = rgb(0x74a345);
    look.leaves = rgb(0x86b552);
    look.foliage = .75f;
    look.turned = 0;
    look.blossom = .3f;
    look.litter = 0;
    look.snow = 0;
    look.wet = 0;
    look.rain = 0;
    look.lamps = false;
    look.noise = 3;
    return look;
}

Condition summer()
{
    Condition look = spring();
    look.name = "summer";
    look.sky_high = rgb(0x3f83d6);
    look.sky_low = rgb(0xc3dcf0);
    look.clouds = .2f;
    look.light = {.98f, 1.04f, 1.08f};
    look.sun = 1;
    look.shadow = .5f;
    look.grass = rgb(0x5f8c34);
    look.leaves = rgb(0x3f7428);
    look.foliage = 1;
    look.blossom = .05f;
    return look;
}

Condition autumn()
{
    Condition look = spring();
    look.name = "autumn";
    look.sky_high = rgb(0x8fa9c4);
    look.sky_low = rgb(0xe2dccb);
    look.clouds = .5f;
    look.light = {.82f, .95f, 1.06f};
    look.sun = .6f;
    look.shadow = 1.5f;
    look.haze_m = 110;
    look.grass = rgb(0x84823f);
    look.leaves = rgb(0x6f7a2c);
    look.foliage = .75f;
    look.turned = 1;
    look.blossom = 0;
    look.litter = .55f;
    return look;
}

Condition winter()
{
    Condition look = spring();
    look.name = "winter";
    look.sky_high = rgb(0x9db6d2);
    look.sky_low = rgb(0xdfe3e8);
    look.clouds = .55f;
    look.light = {1.02f, .98f, .94f};
    look.sun = .45f;
    look.shadow = 1.6f;
    look.haze_m = 130;
    look.grass = rgb(0x8b8557);
    look.leaves = rgb(0x7a6a3c);
    look.foliage = 0;
    look.blossom = 0;
    look.snow = .7f;
    return look;
}

Condition overcast()
{
    Condition look = summer();
    look.name = "overcast";
    look.sky_high = rgb(0xb4bcc4);
    look.sky_low = rgb(0xd6d9dc);
    look.clouds = .9f;
    look.light = {.9f, .86f, .82f};
    look.sun = .1f;
    look.haze_m = 100;
    return look;
}

Condition rain()
{
    Condition look = overcast();
    look.name = "rain";
    look.sky_high = rgb(0x858d96);
    look.sky_low = rgb(0xa9b0b6);
    look.light = {.72f, .67f, .62f};
    look.sun = 0;
    look.haze_m = 50;
    look.wet = .7f;
    look.rain = .8f;
    look.noise = 5;
    return look;
}

Condition dusk()
{
    Condition look = summer();
    look.name = "dusk";
    look.sky_high = rgb(0x3c4a78);
    look.sky_low = rgb(0xe08a4e);
    look.clouds = .45f;
    look.light = {.42f, .36f, .46f};
    look.sun = .3f;
    look.shadow = 2.5f;
    look.lamps = true;
    look.noise = 6;
    return look;
}

Condition night()
{
    Condition look = summer();
    look.name = "night";
    look.sky_high = rgb(0x070a14);
    look.sky_low = rgb(0x141a2a);
    look.clouds = .2f;
    look.light = {.045f, .032f, .028f};
    look.sun = 0;
    look.lamps = true;
    look.noise = 14;
    return look;
}

} // namespace

const std::vector<Condition> &conditions()
{
    static const std::vector<Condition> all = {spring(),   summer(), autumn(), winter(),
                                               overcast(), rain(),   dusk(),   night()};
    return all;
}

const Condition &find_condition(const std::string &name)
{
    std::string known;
    for (const Condition &condition : conditions()) {
        if (condition.name == name)
            return condition;
        known += (known.empty() ? "" : ", ") + condition.name;
    }
    throw program::UsageError("there is no condition '" + name + "'; known ones: " + known);
}

Condition on_another_day(const Condition &condition, float variation, uint64_t seed)
{
    Chance chance(seed);
    const auto shift = [&](float value, float most) {
        return value + variation * chance.between(-most, most);
    };
    // A share of 0 or 1 is part of the condition and stays: no snow falls in summer.
    const auto share = [&](float value) {
        return value <= 0 || value >= 1 ? value : std::clamp(shift(value, .15f), .02f, .98f);
    };
    Condition look = condition;
    for (int channel = 0; channel < 3; channel++)
        look.light[channel] *= shift(1, .06f);
    look.clouds = std::clamp(shift(look.clouds, .3f), 0.f, 1.f);
    look.sun *= 1 - variation * chance.between(0, .3f);
    look.shadow *= shift(1, .3f);
    look.haze_m *= shift(1, .3f);
    look.foliage = share(look.foliage);
    look.blossom = share(look.blossom);
    look.litter = share(look.litter);
    look.snow = share(look.snow);
    return look;
}

} // namespace vdna::simulate
