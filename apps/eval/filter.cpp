#include "eval/filter.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <vdna/cpp/localiser.hpp>

#include "program/interrupt.hpp"
#include "program/median.hpp"

namespace vdna::eval
{

namespace
{

// Map frames within tolerance where there are neither places nor positions to tell.
constexpr uint32_t usual_tolerance = 2;

// The median distance of frames that follow one another, metres; 0 if it is not known.
double spacing_of(const vdna_experience &map)
{
    std::vector<double> spacings;
    for (uint32_t i = 1; map.frame_position && i < map.frames; i++) {
        const double *a = map.frame_position + 3 * (i - 1), *b = a + 3;
        const double apart = std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
        if (std::isfinite(apart)) // not if one is unknown
            spacings.push_back(apart);
    }
    return program::median_of(std::move(spacings));
}

// The places that the filter gathers, as far as frames are good matches of one another.
void set_places(const Drive &drive, const vdna_experience &map, vdna_localise_config &config)
{
    const double spacing = spacing_of(map);
    config.tolerance = usual_tolerance;
    if (spacing > 0)
        config.tolerance = static_cast<uint32_t>(
            std::min(drive.tolerance / spacing, static_cast<double>(map.frames)));
    else if (map.frame_place) {
        config.tolerance = static_cast<uint32_t>(drive.tolerance);
        config.place = map.frame_place;
    }
}

std::vector<Answer> follow(const Drive &drive, const vdna_experience &map,
                           const std::function<Answer(const vdna_localise_answer &)> &answer_of)
{
    const LocaliserMap frames(map.embeddings, map.frames, drive.dim, map.name);
    vdna_localise_config config;
    vdna_localise_config_init(&config);
    set_places(drive, map, config);
    ::vdna::Localiser localiser(frames, config, map.name);

    uint32_t next = drive.begin;
    for (; next < drive.begin + drive.warmup_frames; next++)
        require(vdna_localise_warm_up(localiser.get(), drive.embedding(next)), map.name);
    std::vector<Answer> answers;
    vdna_localise_answer found{};
    for (const uint32_t frame : drive.live) {
        program::require_not_interrupted();
        for (; next <= frame; next++)
            require(vdna_localise_feed(localiser.get(), drive.embedding(next), &found), map.name);
        answers.push_back(answer_of(found));
    }
    return answers;
}

} // namespace

std::vector<Answer> centred(const Drive &drive, const vdna_experience &map)
{
    return follow(drive, map,
                  [](const vdna_localise_answer &found) { return Answer{found.nearest, {}}; });
}

std::vector<Answer> filter(const Drive &drive, const vdna_experience &map)
{
    return follow(drive, map, [](const vdna_localise_answer &found) {
        return Answer{found.frame, found.confidence};
    });
}

} // namespace vdna::eval
