// Localising recorded frames in recorded experiences, and judging the matches.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <vdna/map.h>

#include "record/recording.hpp"
#include "record/truth.hpp"

namespace vdna::record
{

// The match of one live frame.
struct Match {
    const vdna_experience *experience; // borrowed
    uint32_t frame;                    // of the experience
    double distance;                   // of the embeddings, as of the search that found it
    bool good = false;                 // taken within tolerance of the live frame
    bool reachable = false;  // some frame of the experience was taken within tolerance of the live
                             // frame
    uint32_t first_good = 0; // rank, from 1, of the nearest good frame; 0 = none among the
                             // neighbours
    bool judged = false; // the live frame has ground truth; otherwise the three above say nothing
    std::optional<double> confidence = {}; // 0..1, of the place filter; none without it
    bool moving = true; // false: the robot stands, and the place filter repeats its answer
};

// All live frames in one experience, or in all of them at once. Without a common kind of label
// (unit none) no match is judged.
struct Localisation {
    std::string experience; // its name
    Unit unit = Unit::none;
    std::string difference;     // as of Truth
    std::vector<Match> matches; // [live frames]
    uint32_t lost_after = 0;    // live frames after which the place filter had jumped as it does on
                                // another route (VDNA_LOCALISE_LOST_JUMPS); 0 = it never had

    uint32_t judged() const;      // live frames with ground truth
    uint32_t good() const;        // matches within tolerance
    uint32_t unreachable() const; // judged live frames without any frame within tolerance
    // Recall@depth: the share of judged live frames with a good one among their `depth` nearest,
    // NaN if none is judged. depth: at most `neighbours` of localise_in(). Unreachable frames count
    // as failures.
    double recall_percent(uint32_t depth = 1) const;
    // Share of all live frames whose confidence is below `least`, or that have none.
    double unsure_percent(double least) const;
};

// Euclidean distance of two embeddings, [dim] each.
double embedding_distance(const float *a, const float *b, size_t dim);

// Nearest frame for each live frame by Euclidean distance; ties take the lowest index.
// tolerance: inclusive, in the common unit.
// neighbours: number of nearest frames searched for a good one, >= 1.
// with_altitude: as for Truth, which throws Error.
Localisation localise_in(const vdna_experience &experience, const Recording &live, double tolerance,
                         uint32_t neighbours = 1, bool with_altitude = false);

// A live drive in one experience as a robot follows it (vdna/localise.h).
struct Followed {
    Localisation filter;  // by the place filter
    Localisation nearest; // each frame by itself: the nearest about the means, or by Euclidean
                          // distance if the embeddings are not made for means
    std::vector<float> distances; // [live frames][map frames], those of `nearest`; empty if not
                                  // wanted
};

// warmup: the frames before the live ones, for the live mean alone.
// tolerance, with_altitude: as for localise_in(). Throws Error.
Followed follow_in(const vdna_experience &experience, const Recording &warmup,
                   const Recording &live, double tolerance, bool with_altitude = false,
                   bool with_distances = false);

// For each live frame the match of greatest confidence, or without confidences of least distance:
// with one neighbour, as localising in the concatenation of the experiences. Ties take the first
// experience.
Localisation composite_of(const std::vector<Localisation> &parts);

} // namespace vdna::record
