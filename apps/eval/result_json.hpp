// Results for programs: JSON and CSV.
#pragma once

#include <string>
#include <vector>

#include "ablation.hpp"
#include "evaluation.hpp"
#include "print.hpp"

namespace vdna
{

// {"ranking_error_swap_once": ..., ...}; what is not defined is null.
Json json_of(const vdna_ranking_metrics &metrics);

// "recall" and "distance" are what `vdna metrics` reads.
Json json_of(const Evaluation &evaluation, const std::vector<Ablation> &ablations);

// A row for each query and reference, "all" for all references at once.
std::string csv_of(const Evaluation &evaluation);

} // namespace vdna
