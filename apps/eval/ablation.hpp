// What becomes of the ranking when one thing is changed: bins, warmup, taps, or the map.
#pragma once

#include <string>
#include <vector>

#include "eval/evaluate.hpp"

namespace vdna::eval
{

// The methods under one changed value; of MethodResult only name and metrics are filled.
struct AblationRow {
    std::string value; // "1000", "45s", a tap's name, or the traversal that was left out
    std::vector<MethodResult> methods;
};

struct Ablation {
    std::string kind; // one of ablation_kinds
    std::vector<AblationRow> rows;
};

extern const std::vector<std::string> ablation_kinds; // bins, warmup, tap, leave-one-out

// What to change, and to what.
struct AblationPlan {
    std::string kind;
    std::vector<uint32_t> bins;      // none = 10, 50, 100, 500, 1000
    std::vector<std::string> warmup; // none = 5, 10, 25, 50, 100 frames, as far as there are more
    uint32_t range_rule;             // VDNA_RANGE_ABOUT_...
};

// settings: what stays. Throws Error.
Ablation ablate(Frames &frames, const EvaluationSettings &settings, const AblationPlan &plan);

} // namespace vdna::eval
