// Localising recorded frames in recorded experiences, and judging the matches.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <vdna/map.h>

#include "record/recording.hpp"

namespace vdna::record
{

// Unit of the distance between two frames: the kind of label that both sides have.
enum class Unit { none, places, metres };

// "places", "metres" or "".
const char *name_of(Unit unit);

// The match of one live frame.
struct Match {
    const vdna_experience *experience; // borrowed
    uint32_t frame;                    // of the experience
    double distance;                   // of the embeddings, Euclidean
    bool good;                         // taken within tolerance of the live frame
    bool reachable; // some frame of the experience was taken within tolerance of the live frame
    uint32_t first_good; // rank, from 1, of the nearest good frame; 0 = none among the neighbours
};

// All live frames in one experience, or in all of them at once. Without a common kind of label
// (unit none) no match is good or reachable.
struct Localisation {
    std::string experience; // its name
    Unit unit = Unit::none;
    std::vector<Match> matches; // [live frames]

    uint32_t good() const;        // matches within tolerance
    uint32_t unreachable() const; // live frames without any frame within tolerance
    // Recall@depth: the share of live frames with a good one among their `depth` nearest. depth: at
    // most `neighbours` of localise_in(). Unreachable frames count as failures.
    double recall_percent(uint32_t depth = 1) const;
};

// Prefer positions to place numbers if both sides have both.
Unit common_unit(const Recording &live, const vdna_experience &experience);

// Distance between the places of two frames, in the common unit.
double frames_apart(Unit unit, const Recording &live, size_t i, const vdna_experience &experience,
                    size_t j);

// Euclidean distance of two embeddings, [dim] each.
double embedding_distance(const float *a, const float *b, size_t dim);

// Nearest frame for each live frame; ties take the lowest index.
// tolerance: inclusive, in the common unit.
// neighbours: number of nearest frames searched for a good one, >= 1.
Localisation localise_in(const vdna_experience &experience, const Recording &live, double tolerance,
                         uint32_t neighbours = 1);

// Equivalent to localising in the concatenation of the experiences, with one neighbour; ties take
// the first experience.
Localisation composite_of(const std::vector<Localisation> &parts);

} // namespace vdna::record
