#include "localisation.hpp"

#include <algorithm>
#include <cmath>

#include <vdna/knn.h>

#include "check.hpp"

namespace vdna
{

namespace
{

double places_apart(int64_t a, int64_t b)
{
    // The difference of two int64 fits only the unsigned type.
    const uint64_t high = static_cast<uint64_t>(std::max(a, b));
    return static_cast<double>(high - static_cast<uint64_t>(std::min(a, b)));
}

// In the common unit of the two.
double apart(Unit unit, const Recording &live, size_t i, const vdna_experience &experience,
             size_t j)
{
    if (unit == Unit::places)
        return places_apart(live.place[i], experience.frame_place[j]);
    const double *a = &live.position[3 * i], *b = &experience.frame_position[3 * j];
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

Match match_of(const vdna_experience &experience, const Recording &live, uint32_t i)
{
    vdna_knn_match nearest;
    require_ok(vdna_knn(&live.embeddings[size_t{i} * experience.dim], experience.dim,
                        experience.embeddings, experience.frames, 1, &nearest),
               experience.name);
    return {&experience, nearest.index, std::sqrt(nearest.distance_sq), false, false};
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

double Localisation::recall_percent() const
{
    return 100.0 * good() / static_cast<double>(matches.size());
}

Unit common_unit(const Recording &live, const vdna_experience &experience)
{
    if (!live.position.empty() && experience.frame_position)
        return Unit::metres;
    return !live.place.empty() && experience.frame_place ? Unit::places : Unit::none;
}

Localisation localise_in(const vdna_experience &experience, const Recording &live, double tolerance)
{
    Localisation result{experience.name, common_unit(live, experience), {}};
    for (uint32_t i = 0; i < live.frames; i++) {
        Match match = match_of(experience, live, i);
        if (result.unit != Unit::none) {
            match.good = apart(result.unit, live, i, experience, match.frame) <= tolerance;
            for (uint32_t j = 0; j < experience.frames && !match.reachable; j++)
                match.reachable = apart(result.unit, live, i, experience, j) <= tolerance;
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

} // namespace vdna
