// A traversal in the role of the live one: the real selector warms up on its frames.
#pragma once

#include <vector>

#include <vdna/cpp/selector.hpp>

#include "eval/binning.hpp"

namespace vdna::eval
{

// The result of the warmup.
struct LiveRun {
    uint32_t begin = 0;  // first frame of the window: 0 unless camera time ran backwards
    uint32_t frames = 0; // of the window
    uint32_t next = 0;   // first frame to localise; the number of frames if the window never ended
    Counts dna;          // of the window
};

// The inputs of a run.
struct LiveTask {
    size_t traversal;                // of the frames that `binning` counts
    const std::string &length;       // of the warmup, "100" frames or "45s"
    uint32_t frames_min;             // fewest frames of a warmup by time
    const std::vector<float> &range; // [neurons][2]
    uint32_t bins;
    std::vector<vdna_select_candidate> candidates; // counted in the same bins
};

// Feed a selector until it chooses. Repeated runs come from the cache. Throws Error.
LiveRun run_live(Frames &frames, Binning &binning, const LiveTask &task);

} // namespace vdna::eval
