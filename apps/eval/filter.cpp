#include "eval/filter.hpp"

#include <cstring>
#include <functional>

#include <vdna/cpp/experience_localiser.hpp>

#include "program/interrupt.hpp"

namespace vdna::eval
{

namespace
{

std::vector<Answer> follow(const Drive &drive, const vdna_experience &map,
                           const std::function<Answer(const vdna_localise_answer &)> &answer_of)
{
    ExperienceLocaliser localiser(about_its_mean(map), drive.tolerance);
    localiser.warm_up(
        drive.warmup_frames, [&](uint32_t i) { return drive.embedding(drive.begin + i); },
        map.name);
    uint32_t next = drive.begin + drive.warmup_frames;
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

vdna_experience about_its_mean(vdna_experience map)
{
    std::strcpy(map.identity.embedding, "output centred");
    return map;
}

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
