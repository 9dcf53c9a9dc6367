// The ways to rank references that trust knows, beside those of eval/methods.hpp.
#pragma once

#include <string>
#include <vector>

#include "eval/trust_scores.hpp"

namespace vdna::eval
{

struct TrustMethod {
    const char *key;   // in text and JSON
    const char *title; // for people
    // Of each reference of the map, lower is better. own_scale: of the map's runs. bins: distances
    // of the Visual DNA.
    std::vector<double> (*distance)(const TrustCase &c, const std::vector<double> &own_scale,
                                    const std::vector<double> &bins);
};

extern const std::vector<TrustMethod> trust_methods;

} // namespace vdna::eval
