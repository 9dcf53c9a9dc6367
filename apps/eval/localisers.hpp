// The methods that localise live frames: one table of their names, maps and functions.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "record/localisation.hpp"

namespace vdna::eval
{

// A live drive, for a localiser to follow. It may use every frame from `begin` up to the one that
// it answers for, and none after it, as on a robot.
struct Drive {
    const record::Recording &recording;
    uint32_t begin;                    // first frame of the warmup
    uint32_t warmup_frames;            // frames in the live Visual DNA
    const std::vector<uint32_t> &live; // frames to localise, ascending, after the warmup
    uint32_t dim;                      // of the embeddings
    double tolerance;                  // of a good match, places or metres

    const float *embedding(uint32_t frame) const
    {
        return &recording.embeddings[size_t{dim} * frame];
    }
};

// Where a live frame is.
struct Answer {
    uint32_t frame;                   // of the map
    std::optional<double> confidence; // 0..1, if the localiser has one
};

// The map that a localiser gets.
enum class MapKind {
    each,          // each reference in turn
    top,           // the references nearest by Visual DNA, each; the most confident answer counts
    all,           // all references at once, concatenated
    fused,         // all references fused into one, see eval/reference_maps.hpp
    fused_centred, // the same, of embeddings about the mean of their reference
    likelihood,    // the places of the fused map, with the frames of each reference there
};

struct Localiser {
    const char *key;   // on the command line, in JSON, CSV and file names
    const char *title; // for people
    MapKind map;
    uint32_t top; // number of references for MapKind::top; 0 = all
    // An answer for each frame of drive.live. map: at least one frame. Throws Error. NULL for
    // MapKind::likelihood, which eval/bayesian_fusion.hpp answers.
    std::vector<Answer> (*find)(const Drive &drive, const vdna_experience &map);
};

extern const std::vector<Localiser> localisers;

// Those compared unless others are named: they cost nothing beyond the rest of the evaluation.
extern const std::vector<std::string> usual_localisers;

std::vector<std::string> localiser_keys();
// Throws Error if there is none of this name.
const Localiser &localiser_of(const std::string &key);

// Answers in several experiences, to the same frames, made one: for each frame that of most
// confidence, of equals the first experience's. frames: of each experience; answers are then frames
// of the experiences joined in this order. Answers without a confidence are less confident than
// any.
std::vector<Answer> most_confident(const std::vector<std::vector<Answer>> &answers,
                                   const std::vector<uint32_t> &frames);

// The nearest map frame by Euclidean distance of the embeddings; ties take the lowest index.
std::vector<Answer> nearest(const Drive &drive, const vdna_experience &map);

} // namespace vdna::eval
