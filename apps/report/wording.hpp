// Common phrases of the report.
#pragma once

#include <string>

#include "eval/evaluation.hpp"

namespace vdna::report
{

const std::string &name_of(const eval::Evaluation &evaluation, size_t traversal);

// "warmup 100 frames"
std::string warmup_text(const eval::Evaluation &evaluation);
// "tolerance 5 places"
std::string tolerance_text(const eval::Evaluation &evaluation);

// Short enough to compare at a glance, long enough not to hide a difference.
std::string distance_text(double distance);

} // namespace vdna::report
