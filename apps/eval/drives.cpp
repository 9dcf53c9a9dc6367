#include "eval/drives.hpp"

#include <algorithm>
#include <array>

#include <vdna/cpp/error.hpp>

#include "eval/reference_maps.hpp"
#include "record/truth.hpp"

namespace vdna::eval
{

namespace
{

// Frames of the traversal per live frame.
constexpr std::array<double, 5> speeds = {0.5, 0.75, 1, 1.5, 2};

// A frame before `end` that is at least a quarter of the traversal away. end: from three quarters
// of the traversal on, so that there is one.
uint32_t elsewhere(uint32_t at, uint32_t frames, uint32_t end, std::mt19937 &random)
{
    while (true) {
        const auto to = static_cast<uint32_t>(random() % end);
        if (std::max(at, to) - std::min(at, to) >= frames / 4)
            return to;
    }
}

std::vector<DriveStep> plain(uint32_t first, uint32_t frames, std::mt19937 &)
{
    std::vector<DriveStep> steps;
    for (uint32_t frame = first; frame < frames; frame++)
        steps.push_back({frame, frame, false});
    return steps;
}

// Stretches of 10 to 20 frames of one speed; after a third of them a stop of 3 to 10 frames.
// Halfway, the robot is carried elsewhere, not so far that the drive ends at once.
std::vector<DriveStep> varied(uint32_t first, uint32_t frames, std::mt19937 &random)
{
    const uint32_t length = frames - first;
    std::vector<DriveStep> steps;
    bool carried = false;
    double at = first;
    const auto stay = [&] {
        const auto frame = static_cast<uint32_t>(at);
        steps.push_back({frame, frame, false});
    };
    while (steps.size() < length) {
        const double speed = speeds[random() % speeds.size()];
        for (size_t left = 10 + random() % 11; left > 0 && steps.size() < length; left--) {
            if (!carried && steps.size() >= length / 2) {
                at = elsewhere(static_cast<uint32_t>(at), frames, frames - frames / 4, random);
                carried = true;
            }
            stay();
            at += speed;
            if (at >= frames)
                return steps;
        }
        for (size_t left = random() % 3 == 0 ? 3 + random() % 8 : 0; left > 0; left--)
            stay();
    }
    return steps;
}

std::vector<DriveStep> replaced(uint32_t first, uint32_t frames, std::mt19937 &random)
{
    std::vector<DriveStep> steps = plain(first, frames, random);
    for (DriveStep &step : steps)
        if (random() % 10 < 3)
            step.seen = elsewhere(step.at, frames, frames, random);
    return steps;
}

// begin: index of a step.
std::vector<DriveStep> leaving_route(std::vector<DriveStep> steps, size_t begin, size_t count)
{
    for (size_t i = begin; i < begin + count; i++)
        steps[i].off_route = true;
    return steps;
}

std::vector<DriveStep> gap(uint32_t first, uint32_t frames, std::mt19937 &random)
{
    const uint32_t length = frames - first, count = std::min(frames / 4, length / 2);
    return leaving_route(plain(first, frames, random), random() % (length - count + 1), count);
}

std::vector<DriveStep> off_route(uint32_t first, uint32_t frames, std::mt19937 &random)
{
    const uint32_t length = frames - first;
    return leaving_route(plain(first, frames, random), length - length / 2, length / 2);
}

} // namespace

const std::vector<DriveKind> drive_kinds = {
    {"plain", "As recorded", plain},
    {"varied", "Other speeds, stops, carried elsewhere once", varied},
    {"replaced", "30 % of the pictures from elsewhere", replaced},
    {"gap", "A quarter of the route missing in the map", gap},
    {"off-route", "Leaves the route halfway", off_route},
};

std::vector<std::string> drive_keys()
{
    std::vector<std::string> keys;
    for (const DriveKind &kind : drive_kinds)
        keys.push_back(kind.key);
    return keys;
}

const DriveKind &drive_of(const std::string &key)
{
    const auto found = std::find_if(drive_kinds.begin(), drive_kinds.end(),
                                    [&](const DriveKind &kind) { return kind.key == key; });
    if (found == drive_kinds.end())
        throw Error("'" + key + "' is no drive");
    return *found;
}

DrivenQuery drive_through(const DriveKind &kind, const QueryResult &query,
                          const record::Recording &traversal, uint32_t dim, uint32_t stride,
                          uint32_t seed)
{
    std::mt19937 random(seed);
    DrivenQuery driven;
    const auto drive = [&](const DriveStep &step) {
        append(driven.recording, traversal, step.at, dim);
        std::copy_n(&traversal.embeddings[size_t{dim} * step.seen], dim,
                    driven.recording.embeddings.end() - dim);
        driven.off_route.push_back(step.off_route);
    };
    const uint32_t first = query.live.front();
    for (uint32_t frame = query.warmup_begin; frame < first; frame++)
        drive({frame, frame, false});
    const std::vector<DriveStep> steps = kind.steps(first, traversal.frames, random);
    for (size_t i = 0; i < steps.size(); i++) {
        if (i % stride == 0)
            driven.live.push_back(driven.recording.frames);
        drive(steps[i]);
    }
    return driven;
}

record::Recording without_off_route(const record::Recording &map, const DrivenQuery &driven,
                                    uint32_t dim, double tolerance, bool with_altitude)
{
    const record::Truth truth(driven.recording, map_of(map, dim), with_altitude);
    std::vector<uint32_t> off_route;
    for (uint32_t live = 0; live < driven.recording.frames; live++)
        if (driven.off_route[live])
            off_route.push_back(live);
    record::Recording left;
    for (uint32_t frame = 0; frame < map.frames; frame++) {
        const auto is_near = [&](uint32_t live) { return truth.apart(live, frame) <= tolerance; };
        if (std::none_of(off_route.begin(), off_route.end(), is_near))
            append(left, map, frame, dim);
    }
    return left;
}

} // namespace vdna::eval
