// One trial of trust: a live run in a map that knows itself.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <vdna/trust.h>

#include "record/trust_tables.hpp"

namespace vdna::eval
{

// The frames of a warmup, by their relative distances to the nearest frame of each run of a map.
struct LiveFrames {
    uint32_t frames = 0;
    std::vector<double> nearest;    // [frames][runs]
    std::vector<double> likeness;   // [frames][runs], on the last layer; empty = none
    std::vector<double> bins;       // [runs], distance of the Visual DNA of all frames; empty = not
                                    // known
    std::vector<double> bins_early; // of the first VDNA_TRUST_SETTLED_FRAMES
};

// What the frames so far say.
struct Forecast {
    std::vector<vdna_trust_prediction> predictions; // [runs]
    std::vector<double> angle; // [runs], z: the angle of the recall that nearest distances alone
                               // predict, in the definition of `settled`
    vdna_trust_answer answer;
};

struct Trial {
    vdna_trust_fit fit;
    std::vector<double> constant;  // [runs], mean recall of the other stored runs in each, 0..1;
                                   // NaN without labels
    std::optional<Forecast> early; // after VDNA_TRUST_SETTLED_FRAMES; none if the warmup is shorter
    Forecast full;
    uint32_t settled_frames = 0; // after which the choice had settled; 0 = not before the end
    uint32_t settled_choice = 0; // the choice then, or at the end
};

// Tables of some of the runs.
record::TrustTables tables_of(const record::TrustTables &tables, const std::vector<uint32_t> &runs);
LiveFrames frames_in(const LiveFrames &live, size_t runs_before, const std::vector<uint32_t> &runs);

// localiser: VDNA_TRUST_CENTRED or _EUCLIDEAN. live: at least one frame. Throws Error.
Trial try_trust(const record::TrustTables &tables, uint32_t localiser, const LiveFrames &live);

} // namespace vdna::eval
