// Localising recorded frames in recorded experiences, and whether that was right.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <vdna/map.h>

#include "recording.hpp"

namespace vdna
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
};

// All live frames in one experience, or in all of them at once. Without a common kind of label
// (unit none) nothing is good or reachable.
struct Localisation {
    std::string experience; // its name
    Unit unit = Unit::none;
    std::vector<Match> matches; // [live frames]

    uint32_t good() const;         // matches within tolerance
    uint32_t unreachable() const;  // live frames that no frame of the experience is near to
    double recall_percent() const; // Recall@1: unreachable frames count as failures
};

// Positions are preferred to place numbers where both sides have both.
Unit common_unit(const Recording &live, const vdna_experience &experience);

// Nearest frame for each live frame; ties take the lowest index.
// tolerance: inclusive, in the common unit.
Localisation localise_in(const vdna_experience &experience, const Recording &live,
                         double tolerance);

// The same as localising in the concatenation of the experiences; ties take the first of them.
Localisation composite_of(const std::vector<Localisation> &parts);

} // namespace vdna
