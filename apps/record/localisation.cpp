#include "record/localisation.hpp"

#include <algorithm>
#include <cmath>

#include <vdna/cpp/error.hpp>
#include <vdna/knn.h>

namespace vdna::record
{

namespace
{

double places_apart(int64_t a, int64_t b)
{
    // The difference of two int64 needs the unsigned type.
    const uint64_t high = static_cast<uint64_t>(std::max(a, b));
    return static_cast<double>(high - static_cast<uint64_t>(std::min(a, b)));
}

// The nearest frame of live frame i, not yet judged.
Match match_of(const vdna_experience &experience, const Recording &live, uint32_t i,
               std::vector<vdna_knn_match> &nearest)
{
    require(vdna_knn(&live.embeddings[size_t{i} * experience.identity.dim], experience.identity.dim,
                     experience.embeddings, experience.frames,
                     static_cast<uint32_t>(nearest.size()), nearest.data()),
            experience.name);
    return {&experience, nearest[0].index, std::sqrt(nearest[0].distance_sq), false, false, 0};
}

} // namespace

const char *name_of(Unit unit)
{
    return unit == Unit::places ? "places" : unit == Unit::metres ? "metres" : "";
}

uint32_t Localisation::good() const
{
    const auto is_good = [](const Match &match) { return match.good; };
    return static_cast<uint32_t>(std::count_if(matches.begin(), matches.end(), is_good));
}

uint32_t Localisation::unreachable() const
{
    const auto is_lost = [](const Match &match) { return !match.reachable; };
    return static_cast<uint32_t>(std::count_if(matches.begin(), matches.end(), is_lost));
}

double Localisation::recall_percent(uint32_t depth) const
{
    const auto is_found = [&](const Match &match) {
        return match.first_good >= 1 && match.first_good <= depth;
    };
    return 100.0 * static_cast<double>(std::count_if(matches.begin(), matches.end(), is_found)) /
           static_cast<double>(matches.size());
}

Unit common_unit(const Recording &live, const vdna_experience &experience)
{
    if (!live.position.empty() && experience.frame_position)
        return Unit::metres;
    return !live.place.empty() && experience.frame_place ? Unit::places : Unit::none;
}

double frames_apart(Unit unit, const Recording &live, size_t i, const vdna_experience &experience,
                    size_t j)
{
    if (unit == Unit::places)
        return places_apart(live.place[i], experience.frame_place[j]);
    const double *a = &live.position[3 * i], *b = &experience.frame_position[3 * j];
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
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
                         uint32_t neighbours)
{
    Localisation result{experience.name, common_unit(live, experience), {}};
    std::vector<vdna_knn_match> nearest(std::min(neighbours, experience.frames));
    for (uint32_t i = 0; i < live.frames; i++) {
        Match match = match_of(experience, live, i, nearest);
        const auto is_good = [&](uint32_t j) {
            return frames_apart(result.unit, live, i, experience, j) <= tolerance;
        };
        if (result.unit != Unit::none) {
            for (uint32_t n = 0; n < nearest.size() && match.first_good == 0; n++)
                match.first_good = is_good(nearest[n].index) ? n + 1 : 0;
            match.good = match.first_good == 1;
            match.reachable = match.first_good > 0;
            for (uint32_t j = 0; j < experience.frames && !match.reachable; j++)
                match.reachable = is_good(j);
        }
        result.matches.push_back(match);
    }
    return result;
}

Localisation composite_of(const std::vector<Localisation> &parts)
{
    Localisation all = parts.front();
    all.experience = "all";
    for (const Localisation &part : parts) {
        if (part.unit != all.unit)
            all.unit = Unit::none;
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
