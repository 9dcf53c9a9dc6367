// The paper's evaluation: every traversal in turn is the live one, the others are the map.
#pragma once

#include <string>
#include <vector>

#include <vdna/cpp/selector.hpp>

#include "eval/binning.hpp"
#include "eval/evaluation.hpp"

namespace vdna::eval
{

struct EvaluationSettings {
    uint32_t bins = VDNA_HIST_BINS_DEFAULT;
    std::string warmup;                                          // "100" frames or "45s"
    uint32_t warmup_frames_min = VDNA_WARMUP_FRAMES_MIN_DEFAULT; // of a warmup by time
    double tolerance = 5;                                        // inclusive
    bool with_altitude = false;          // distances through space instead of horizontal ones
    uint32_t stride = 1;                 // every stride-th frame after the warmup is localised
    std::vector<std::string> taps;       // none = all
    std::vector<std::string> queries;    // traversals; none = all
    std::vector<std::string> references; // traversals; none = all
};

// binning: of these frames; both must outlive the result. Shows progress. Throws Error.
Evaluation evaluate(Frames &frames, Binning &binning, const EvaluationSettings &settings);

} // namespace vdna::eval
