// Drives through a query's frames: as they were recorded, and disturbed as robots disturb them.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "eval/evaluation.hpp"
#include "record/recording.hpp"

namespace vdna::eval
{

// One live frame. Frames are those of the query's traversal.
struct DriveStep {
    uint32_t at;    // where the robot is
    uint32_t seen;  // what its camera shows
    bool off_route; // no map has this place
};

struct DriveKind {
    const char *key;   // on the command line and in JSON
    const char *title; // for people
    // The drive after the warmup. first: frame after the warmup; frames: of the traversal, more
    // than `first`. At least one step. The same state of `random` gives the same drive.
    std::vector<DriveStep> (*steps)(uint32_t first, uint32_t frames, std::mt19937 &random);
};

// The drive as it was recorded comes first. docs/internals/DESIGN.md, Metrics, defines the others.
extern const std::vector<DriveKind> drive_kinds;

std::vector<std::string> drive_keys();
// Throws Error if there is none of this name.
const DriveKind &drive_of(const std::string &key);

// A drive of one query: the frames of its warmup, and then those of the steps.
struct DrivenQuery {
    record::Recording recording; // labels of where the robot is, embeddings of what it sees
    std::vector<uint32_t> live;  // frames of `recording` to localise, every stride-th step
    std::vector<bool> off_route; // [recording.frames]
};

// traversal: the query's. seed: another one gives another drive.
DrivenQuery drive_through(const DriveKind &kind, const QueryResult &query,
                          const record::Recording &traversal, uint32_t dim, uint32_t stride,
                          uint32_t seed);

// The frames of a map that are farther than the tolerance from all places off the route. Throws
// Error.
record::Recording without_off_route(const record::Recording &map, const DrivenQuery &driven,
                                    uint32_t dim, double tolerance, bool with_altitude);

} // namespace vdna::eval
