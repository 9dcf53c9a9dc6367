#include "eval/trust_methods.hpp"

#include <algorithm>
#include <cmath>

namespace vdna::eval
{

namespace
{

using Distances = std::vector<double>;

// What a method falls back to where it has no number for a reference.
Distances known(const Distances &distance, const Distances &otherwise)
{
    const bool all = std::none_of(distance.begin(), distance.end(),
                                  [](double value) { return std::isnan(value); });
    return all ? distance : otherwise;
}

Distances by_nearest(const TrustCase &c, const Distances &own_scale, const Distances &)
{
    Distances distance;
    for (size_t b = 0; b < c.columns.size(); b++)
        distance.push_back(c.trial.full.predictions[b].nearest * own_scale[b]);
    return distance;
}

Distances by_relative(const TrustCase &c, const Distances &own_scale, const Distances &bins)
{
    Distances distance;
    for (const double angle : c.trial.full.angle)
        distance.push_back(-angle);
    return known(distance, by_nearest(c, own_scale, bins));
}

Distances by_transfer(const TrustCase &c, const Distances &, const Distances &bins)
{
    Distances distance;
    for (const vdna_trust_prediction &p : c.trial.full.predictions)
        distance.push_back(-p.transfer);
    return known(distance, bins);
}

Distances by_prediction(const TrustCase &c, const Distances &own_scale, const Distances &bins)
{
    Distances distance;
    for (const vdna_trust_prediction &p : c.trial.full.predictions)
        distance.push_back(-p.recall);
    return known(distance, by_transfer(c, own_scale, bins));
}

} // namespace

const std::vector<TrustMethod> trust_methods = {
    {"nearest", "Nearest-frame distance", by_nearest},
    {"relative", "Recall by relative nearest-frame distance", by_relative},
    {"transfer", "Recall by transfer", by_transfer},
    {"predicted", "Predicted recall", by_prediction},
};

} // namespace vdna::eval
