// Localising recorded frames in recorded experiences, and whether that was right.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <vdna/map.h>

#include "record/recording.hpp"

namespace vdna::record
{

// How far apart two frames were taken is measured in what both sides are labelled with.
enum class Unit { none, places, metres };

// "places", "metres" or "".
const char *name_of(Unit unit);

// Where one live frame was found.
struct Match {
    const vdna_experience *experience; // borrowed
    uint32_t frame;                    // of it
    double distance;                   // of the embeddings, Euclidean
    bool good;                         // taken within tolerance of the live frame
    bool reachable; // some frame of the experience was taken within tolerance of the live frame
    uint32_t first_good; // rank, from 1, of the nearest frame that is good; 0 = none of those asked
};

// All live frames in one experience, or in all of them at once. Without a common kind of label
// (unit none) nothing is good or reachable.
struct Localisation {
    std::string experience; // its name
    Unit unit = Unit::none;
    std::vector<Match> matches; // [live frames]

    uint32_t good() const;        // matches within tolerance
    uint32_t unreachable() const; // live frames that no frame of the experience is near to
    // Recall@depth: the share of live frames with a good one among their `depth` nearest, which
    // must not be more than were asked for. Unreachable frames count as failures.
    double recall_percent(uint32_t depth = 1) const;
};

// Positions are preferred to place numbers where both sides have both.
Unit common_unit(const Recording &live, const vdna_experience &experience);

// How far apart two frames were taken, in the common unit.
double frames_apart(Unit unit, const Recording &live, size_t i, const vdna_experience &experience,
                    size_t j);

// Euclidean distance of two embeddings, [dim] each.
double embedding_distance(const float *a, const float *b, size_t dim);

// Nearest frame for each live frame; ties take the lowest index.
// tolerance: inclusive, in the common unit.
// neighbours: the nearest so many frames are asked for a good one, >= 1.
Localisation localise_in(const vdna_experience &experience, const Recording &live, double tolerance,
                         uint32_t neighbours = 1);

// The same as localising in the concatenation of the experiences, one neighbour each; ties take the
// first of them.
Localisation composite_of(const std::vector<Localisation> &parts);

} // namespace vdna::record
