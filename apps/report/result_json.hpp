// Results for programs: JSON and CSV.
#pragma once

#include <string>
#include <vector>

#include "eval/ablation.hpp"
#include "eval/evaluation.hpp"
#include "program/print.hpp"

namespace vdna::report
{

// {"ranking_error_swap_once": ..., ..., "intervals": {"ranking_error_swap_once": [low, high],
// ...}}; undefined numbers are null.
program::Json json_of(const eval::JudgedRanking &judged);

// `vdna metrics` reads "recall" and "distance".
program::Json json_of(const eval::Evaluation &evaluation,
                      const std::vector<eval::Ablation> &ablations);

// A row for each query and reference, "all" for all references at once.
std::string csv_of(const eval::Evaluation &evaluation);

// A row for each average over queries, with the ends of its 95 % interval.
std::string averages_csv_of(const eval::Evaluation &evaluation,
                            const std::vector<eval::Ablation> &ablations);

} // namespace vdna::report
