#include "eval/localise_query.hpp"

#include <algorithm>

#include <vdna/cpp/error.hpp>

namespace vdna::eval
{

namespace
{

// Append frame i of another recording.
void append(record::Recording &to, const record::Recording &from, uint32_t i, uint32_t dim)
{
    to.frames++;
    to.position_frame = from.position_frame;
    if (!from.place.empty())
        to.place.push_back(from.place[i]);
    if (!from.position.empty())
        to.position.insert(to.position.end(), &from.position[size_t{3} * i],
                           &from.position[size_t{3} * i] + 3);
    to.embeddings.insert(to.embeddings.end(), &from.embeddings[size_t{dim} * i],
                         &from.embeddings[size_t{dim} * i] + dim);
}

// One experience of all frames of these traversals, concatenated.
record::Recording joined(const QueryTask &task, const std::vector<size_t> &references)
{
    record::Recording all;
    for (const size_t reference : references) {
        const record::Recording &recording = task.traversals[reference].recording;
        for (uint32_t i = 0; i < recording.frames; i++)
            append(all, recording, i, task.dim);
    }
    return all;
}

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

vdna_experience map_of(const record::Recording &recording, uint32_t dim)
{
    vdna_experience map{};
    map.frames = recording.frames;
    map.identity.dim = dim;
    map.embeddings = recording.embeddings.data();
    map.frame_place = recording.place.empty() ? nullptr : recording.place.data();
    map.frame_position = recording.position.empty() ? nullptr : recording.position.data();
    recording.position_frame.copy(map.position_frame, sizeof map.position_frame - 1);
    return map;
}

Outcome localise_query(const QueryTask &task, const std::vector<size_t> &references)
{
    const record::Recording &traversal = task.traversals[task.query.traversal].recording;
    record::Recording live;
    for (const uint32_t i : task.query.live)
        append(live, traversal, i, task.dim);
    const record::Recording recording = joined(task, references);
    const vdna_experience map = map_of(recording, task.dim);
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
