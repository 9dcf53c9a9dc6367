// The sections of the report, each from its <h2> on.
#pragma once

#include <string>
#include <vector>

#include "eval/ablation.hpp"
#include "eval/evaluation.hpp"

namespace vdna::report
{

// Sections with a part for each query show so many of them, and so many references for each: what
// a reader can compare, and what keeps the page small.
constexpr size_t shown_most = 12;

// How well each method ranks, one row per method.
std::string averages_section(const eval::Evaluation &evaluation);

// The true ranking of each query, and that of each method with its mistakes.
std::string rankings_section(const eval::Evaluation &evaluation);

// Difference and ground-truth matrices.
std::string matrices_section(const eval::Evaluation &evaluation);

// Distance against recall, a chart per method.
std::string correlation_section(const eval::Evaluation &evaluation);

// Pictures of right and wrong matches in the first choice. Reads pictures.
std::string matches_section(const eval::Evaluation &evaluation);

// Which neurons tell the references apart.
std::string neurons_section(const eval::Evaluation &evaluation);

// "" if there are none.
std::string ablations_section(const std::vector<eval::Ablation> &ablations);

} // namespace vdna::report
