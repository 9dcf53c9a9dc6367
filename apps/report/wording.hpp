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

// "54.21 (50.10 to 58.30)", without the interval if there is none; "-" for NaN.
std::string mean_text(const eval::Mean &mean, int digits = 2);

// Says which queries the metrics leave out because their truth ranks nothing; "" if there are none.
std::string left_out_text(const vdna_ranking_metrics &metrics);

// The same of one query.
extern const char *const ranks_nothing;

} // namespace vdna::report
