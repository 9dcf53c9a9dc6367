#include "eval/filter.hpp"

#include <cstring>

#include <vdna/cpp/experience_localiser.hpp>

#include "program/interrupt.hpp"

namespace vdna::eval
{

vdna_experience about_its_mean(vdna_experience map)
{
    std::strcpy(map.identity.embedding, "output centred");
    return map;
}

void follow(const Drive &drive, const vdna_experience &map,
            const std::function<void(const vdna_localise_answer &, const float *)> &take)
{
    ExperienceLocaliser localiser(about_its_mean(map), drive.tolerance);
    localiser.warm_up(
        drive.warmup_frames, [&](uint32_t i) { return drive.embedding(drive.begin + i); },
        map.name);
    uint32_t next = drive.begin + drive.warmup_frames;
    vdna_localise_answer found{};
    for (const uint32_t frame : drive.live) {
        program::require_not_interrupted();
        for (; next <= frame; next++)
            require(vdna_localise_feed(localiser.get(), drive.embedding(next), &found), map.name);
        take(found, vdna_localise_distances(localiser.get()));
    }
}

std::vector<Answer> centred(const Drive &drive, const vdna_experience &map)
{
    std::vector<Answer> answers;
    follow(drive, map, [&](const vdna_localise_answer &found, const float *) {
        answers.push_back({found.nearest, {}});
    });
    return answers;
}

std::vector<Answer> filter(const Drive &drive, const vdna_experience &map)
{
    std::vector<Answer> answers;
    follow(drive, map, [&](const vdna_localise_answer &found, const float *) {
        answers.push_back({found.frame, found.confidence});
    });
    return answers;
}

} // namespace vdna::eval
