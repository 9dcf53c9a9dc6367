#include "record/localisation.hpp"

#include <algorithm>
#include <cmath>

#include <vdna/cpp/error.hpp>
#include <vdna/knn.h>

namespace vdna::record
{

namespace
{

// The nearest frame of live frame i, not yet judged.
Match match_of(const vdna_experience &experience, const Recording &live, uint32_t i,
               std::vector<vdna_knn_match> &nearest)
{
    require(vdna_knn(&live.embeddings[size_t{i} * experience.identity.dim], experience.identity.dim,
                     experience.embeddings, experience.frames,
                     static_cast<uint32_t>(nearest.size()), nearest.data()),
            experience.name);
    return {&experience, nearest[0].index, std::sqrt(nearest[0].distance_sq), false, false, 0,
            false};
}

// Judge a match by its nearest frames, and by all others if they are not good.
void judge(Match &match, uint32_t i, const std::vector<vdna_knn_match> &nearest, const Truth &truth,
           double tolerance)
{
    const auto is_good = [&](uint32_t j) { return truth.apart(i, j) <= tolerance; };
    match.judged = true;
    for (uint32_t n = 0; n < nearest.size() && match.first_good == 0; n++)
        match.first_good = is_good(nearest[n].index) ? n + 1 : 0;
    match.good = match.first_good == 1;
    match.reachable = match.first_good > 0;
    for (uint32_t j = 0; j < match.experience->frames && !match.reachable; j++)
        match.reachable = is_good(j);
}

} // namespace

uint32_t Localisation::judged() const
{
    const auto is_judged = [](const Match &match) { return match.judged; };
    return static_cast<uint32_t>(std::count_if(matches.begin(), matches.end(), is_judged));
}

uint32_t Localisation::good() const
{
    const auto is_good = [](const Match &match) { return match.good; };
    return static_cast<uint32_t>(std::count_if(matches.begin(), matches.end(), is_good));
}

uint32_t Localisation::unreachable() const
{
    const auto is_lost = [](const Match &match) { return match.judged && !match.reachable; };
    return static_cast<uint32_t>(std::count_if(matches.begin(), matches.end(), is_lost));
}

double Localisation::recall_percent(uint32_t depth) const
{
    const auto is_found = [&](const Match &match) {
        return match.first_good >= 1 && match.first_good <= depth;
    };
    return 100.0 * static_cast<double>(std::count_if(matches.begin(), matches.end(), is_found)) /
           judged();
}

double embedding_distance(const float *a, const float *b, size_t dim)
{
    double sum = 0;
    for (size_t i = 0; i < dim; i++) {
        const double d = double{a[i]} - double{b[i]};
        sum += d * d;
    }
    return std::sqrt(sum);
}

Localisation localise_in(const vdna_experience &experience, const Recording &live, double tolerance,
                         uint32_t neighbours, bool with_altitude)
{
    const Truth truth(live, experience, with_altitude);
    Localisation result{experience.name, truth.unit(), truth.difference(), {}};
    std::vector<vdna_knn_match> nearest(std::min(neighbours, experience.frames));
    for (uint32_t i = 0; i < live.frames; i++) {
        Match match = match_of(experience, live, i, nearest);
        if (truth.knows(i))
            judge(match, i, nearest, truth, tolerance);
        result.matches.push_back(match);
    }
    return result;
}

Localisation composite_of(const std::vector<Localisation> &parts)
{
    Localisation all = parts.front();
    all.experience = "all";
    for (const Localisation &part : parts) {
        if (part.unit != all.unit) {
            all.unit = Unit::none;
            all.difference.clear();
        }
        for (size_t i = 0; i < all.matches.size(); i++) {
            const bool reachable = all.matches[i].reachable || part.matches[i].reachable;
            if (part.matches[i].distance < all.matches[i].distance)
                all.matches[i] = part.matches[i];
            all.matches[i].reachable = reachable;
        }
    }
    return all;
}

} // namespace vdna::record
