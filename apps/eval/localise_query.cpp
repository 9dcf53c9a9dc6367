#include "eval/localise_query.hpp"

#include <algorithm>

#include <vdna/cpp/error.hpp>

#include "eval/reference_maps.hpp"

namespace vdna::eval
{

namespace
{

// The traversal of a frame of joined(); `frame` becomes its index in that traversal.
size_t split(const QueryTask &task, const std::vector<size_t> &references, uint32_t &frame)
{
    for (const size_t reference : references) {
        const uint32_t frames = task.traversals[reference].recording.frames;
        if (frame < frames)
            return reference;
        frame -= frames;
    }
    throw Error("a match lies outside of its map"); // unreachable
}

// The first traversal that has no ground truth at all, or no position, to say what is missing.
std::string without_labels(const std::vector<Traversal> &traversals)
{
    for (const Traversal &t : traversals)
        if (t.recording.position.empty() && t.recording.place.empty())
            return "; " + t.name + " has none";
    return "";
}

} // namespace

Outcome localise_query(const QueryTask &task, const std::vector<size_t> &references)
{
    const record::Recording &traversal = task.traversals[task.query.traversal].recording;
    record::Recording live;
    for (const uint32_t i : task.query.live)
        append(live, traversal, i, task.dim);
    live = record::projected(std::move(live), task.query.projection);
    std::vector<const record::Recording *> parts;
    for (const size_t reference : references)
        parts.push_back(&task.traversals[reference].recording);
    const record::Recording recording =
        record::projected(joined(parts, task.dim), task.query.projection);
    vdna_experience map = map_of(recording, task.dim);
    task.query.projection.set_in(map.identity);
    const record::Localisation found =
        record::localise_in(map, live, task.tolerance, recall_depths.back(), task.with_altitude);

    Outcome outcome{{}, found.judged(), found.good(), found.unreachable(), {}};
    for (size_t i = 0; i < recall_depths.size(); i++)
        outcome.recall[i] = found.recall_percent(recall_depths[i]);
    for (size_t i = 0; i < found.matches.size(); i++) {
        const record::Match &match = found.matches[i];
        uint32_t frame = match.frame;
        const size_t reference = split(task, references, frame);
        outcome.matches.push_back({task.query.live[i], reference, frame, match.distance, match.good,
                                   match.reachable, match.judged});
    }
    return outcome;
}

record::Unit unit_of(const std::vector<Traversal> &traversals)
{
    const auto all = [&](auto has) {
        return std::all_of(traversals.begin(), traversals.end(),
                           [&](const Traversal &t) { return has(t.recording); });
    };
    const bool positions = all([](const record::Recording &r) { return !r.position.empty(); });
    const std::string &frame = traversals.front().recording.position_frame;
    const auto other = std::find_if(traversals.begin(), traversals.end(), [&](const Traversal &t) {
        return t.recording.position_frame != frame;
    });
    if (positions && other == traversals.end())
        return record::Unit::metres;
    if (all([](const record::Recording &r) { return !r.place.empty(); }))
        return record::Unit::places;
    throw Error("the traversals are not labelled alike, expected positions in one frame or place "
                "numbers in all of them" +
                (positions ? "; " + traversals.front().name + " is in frame " + frame + ", " +
                                 other->name + " in " + other->recording.position_frame
                           : without_labels(traversals)));
}

} // namespace vdna::eval
