// Results for programs: JSON and CSV.
#pragma once

#include <string>
#include <vector>

#include "eval/ablation.hpp"
#include "eval/evaluation.hpp"
#include "program/print.hpp"

namespace vdna::report
{

// {"ranking_error_swap_once": ..., ...}; undefined metrics are null.
program::Json json_of(const vdna_ranking_metrics &metrics);

// `vdna metrics` reads "recall" and "distance".
program::Json json_of(const eval::Evaluation &evaluation,
                      const std::vector<eval::Ablation> &ablations);

// A row for each query and reference, "all" for all references at once.
std::string csv_of(const eval::Evaluation &evaluation);

} // namespace vdna::report
