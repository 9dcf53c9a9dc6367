#include "record/localisation.hpp"

#include <algorithm>
#include <cmath>

#include <vdna/cpp/error.hpp>
#include <vdna/cpp/experience_localiser.hpp>
#include <vdna/knn.h>

#include "program/interrupt.hpp"

namespace vdna::record
{

namespace
{

// The nearest frame of live frame i, not yet judged.
Match match_of(const vdna_experience &experience, const Recording &live, uint32_t i,
               std::vector<vdna_knn_match> &nearest)
{
    require(vdna_knn(live.embedding(i), experience.identity.dim, experience.embeddings,
                     experience.frames, static_cast<uint32_t>(nearest.size()), nearest.data()),
            experience.name);
    return {&experience, nearest[0].index, std::sqrt(nearest[0].distance_sq)};
}

void add_euclidean(const vdna_experience &experience, const float *embedding,
                   std::vector<float> &distances)
{
    const uint32_t dim = experience.identity.dim;
    for (size_t j = 0; j < experience.frames; j++)
        distances.push_back(static_cast<float>(
            embedding_distance(embedding, experience.embeddings + dim * j, dim)));
}

bool is_better(const Match &a, const Match &b)
{
    return a.confidence && b.confidence ? *a.confidence > *b.confidence : a.distance < b.distance;
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

double Localisation::unsure_percent(double least) const
{
    const auto is_unsure = [&](const Match &match) { return match.confidence.value_or(0) < least; };
    return 100.0 * static_cast<double>(std::count_if(matches.begin(), matches.end(), is_unsure)) /
           static_cast<double>(matches.size());
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

Followed follow_in(const vdna_experience &experience, const Recording &warmup,
                   const Recording &live, double tolerance, bool with_altitude, bool with_distances)
{
    const Truth truth(live, experience, with_altitude);
    ExperienceLocaliser localiser(experience, tolerance);
    const bool is_centred = vdna_identity_is_centred(&experience.identity) != 0;
    localiser.warm_up(
        warmup.frames, [&](uint32_t i) { return warmup.embedding(i); }, experience.name);

    Followed result;
    result.filter = {experience.name, truth.unit(), truth.difference(), {}};
    result.nearest = result.filter;
    std::vector<vdna_knn_match> euclidean(1);
    for (uint32_t i = 0; i < live.frames; i++) {
        program::require_not_interrupted();
        vdna_localise_answer answer;
        require(vdna_localise_feed(localiser.get(), live.embedding(i), &answer), experience.name);
        if (result.filter.lost_after == 0 &&
            vdna_localise_jumps(localiser.get()) >= VDNA_LOCALISE_LOST_JUMPS)
            result.filter.lost_after = i + 1;
        const float *const distances = vdna_localise_distances(localiser.get());
        Match filter{&experience, answer.frame, distances[answer.frame]};
        filter.confidence = answer.confidence;
        filter.moving = answer.moving != 0;
        Match nearest = is_centred ? Match{&experience, answer.nearest, answer.nearest_distance}
                                   : match_of(experience, live, i, euclidean);
        for (Match *match : {&filter, &nearest})
            if (truth.knows(i))
                judge(*match, i, {{0, match->frame, 0}}, truth, tolerance);
        result.filter.matches.push_back(filter);
        result.nearest.matches.push_back(nearest);
        if (with_distances && is_centred)
            result.distances.insert(result.distances.end(), distances,
                                    distances + experience.frames);
        else if (with_distances)
            add_euclidean(experience, live.embedding(i), result.distances);
    }
    return result;
}

Localisation composite_of(const std::vector<Localisation> &parts)
{
    Localisation all = parts.front();
    all.experience = "all";
    all.lost_after = 0;
    for (const Localisation &part : parts) {
        if (part.unit != all.unit) {
            all.unit = Unit::none;
            all.difference.clear();
        }
        for (size_t i = 0; i < all.matches.size(); i++) {
            const bool reachable = all.matches[i].reachable || part.matches[i].reachable;
            if (is_better(part.matches[i], all.matches[i]))
                all.matches[i] = part.matches[i];
            all.matches[i].reachable = reachable;
        }
    }
    return all;
}

} // namespace vdna::record
