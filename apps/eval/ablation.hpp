// The effect on the ranking of changing one thing: bins, warmup, taps, or the map.
#pragma once

#include <string>
#include <vector>

#include "eval/evaluate.hpp"

namespace vdna::eval
{

// The methods with one changed value; only name and judgement of MethodResult are filled.
struct AblationRow {
    std::string value; // "1000", "45s", a tap's name, or the traversal that was left out
    std::vector<MethodResult> methods;
};

struct Ablation {
    std::string kind; // one of ablation_kinds
    std::vector<AblationRow> rows;
};

extern const std::vector<std::string> ablation_kinds; // bins, warmup, tap, leave-one-out

// The kind of change, and its values.
struct AblationPlan {
    std::string kind;
    std::vector<uint32_t> bins;      // none = 10, 50, 100, 500, 1000
    std::vector<std::string> warmup; // none = those of 5, 10, 25, 50, 100 frames that fit
    uint32_t range_rule;             // VDNA_RANGE_ABOUT_...
};

// settings: everything else, unchanged. Throws Error.
Ablation ablate(Frames &frames, const EvaluationSettings &settings, const AblationPlan &plan);

} // namespace vdna::eval
