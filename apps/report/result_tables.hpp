// The paper's tables as text.
#pragma once

#include <string>
#include <vector>

#include "eval/ablation.hpp"
#include "eval/evaluation.hpp"

namespace vdna::report
{

// For each query, the references by recall, then by each method; and the errors of the methods.
// colour: show misplaced references in orange (one rank off) and red (two or more) as in the paper,
// with terminal escape sequences; otherwise mark them * and **.
std::string tables_of(const eval::Evaluation &evaluation, bool colour);

// One line per method, and one for its 95 % intervals over queries.
std::string error_table(const std::vector<eval::MethodResult> &methods);

// One line per value.
std::string table_of(const eval::Ablation &ablation);

} // namespace vdna::report
