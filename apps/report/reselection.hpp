// Choosing again while driving, as text and as JSON.
#pragma once

#include <string>

#include "eval/evaluation.hpp"
#include "program/print.hpp"

namespace vdna::report
{

// A row for each drive, and one for their means. The evaluation must have a reselection.
std::string reselection_table(const eval::Evaluation &evaluation);

// {"drives": {name: {"again_percent", ..., "choices", "since", "changes", "delays"}}, "mean":
// {"again", ..., "gain"}}
program::Json reselection_json(const eval::Evaluation &evaluation);

} // namespace vdna::report
