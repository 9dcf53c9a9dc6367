// The tables of an evaluation for LaTeX, as the paper prints them.
#pragma once

#include <string>

#include "eval/evaluation.hpp"

namespace vdna::report
{

// Tables to \input; the packages that they need are named at the top. For each group of queries,
// the references by recall, then by each method, with misplaced ones in the paper's colours; then
// the ranking errors and the localisers, with 95 % intervals.
std::string latex_of(const eval::Evaluation &evaluation);

// Text as LaTeX prints it literally, on one line.
std::string latex_escaped(const std::string &text);

} // namespace vdna::report
