#include "eval/methods.hpp"

#include <algorithm>

#include <vdna/baseline.h>
#include <vdna/cpp/error.hpp>

namespace vdna::eval
{

namespace
{

constexpr const char *of_tap = "vdna:";

double visual_dna(const Comparison &c)
{
    return c.distance_bins;
}

double frechet(const Comparison &c)
{
    const std::vector<float> &live = c.live.last_layer_or_only(), &map = c.map.last_layer_or_only();
    const size_t dim = live.size() / c.live.frames;
    double distance = 0;
    require(vdna_frechet(&live[dim * c.begin], c.frames, map.data(), c.map.frames,
                         static_cast<uint32_t>(dim), &distance),
            "Frechet distance");
    return distance;
}

double intensity(const Comparison &c)
{
    double distance = 0;
    require(
        vdna_intensity(&c.live.grey[c.begin], c.frames, c.map.grey.data(), c.map.frames, &distance),
        "pixel intensity");
    return distance;
}

const Method *find(const std::string &key)
{
    const auto found = std::find_if(methods.begin(), methods.end(),
                                    [&](const Method &method) { return method.key == key; });
    return found == methods.end() ? nullptr : &*found;
}

} // namespace

const std::vector<Method> methods = {
    {"vdna", "Visual DNA", "bins", visual_dna},
    {"fd", "Fréchet distance", "squared embedding units", frechet},
    {"pixel", "Pixel intensity", "grey levels", intensity},
    {"random", "Chance", "", nullptr},
};

std::string key_of_tap(const std::string &tap)
{
    return of_tap + tap;
}

bool is_of_tap(const std::string &key)
{
    return key.rfind(of_tap, 0) == 0;
}

std::string title_of(const std::string &key)
{
    if (is_of_tap(key))
        return std::string(methods.front().title) + " of tap " +
               key.substr(std::string(of_tap).size());
    const Method *method = find(key);
    return method ? method->title : key;
}

std::string unit_of(const std::string &key)
{
    const Method *method = is_of_tap(key) ? &methods.front() : find(key);
    return method ? method->unit : "";
}

} // namespace vdna::eval
