// An evaluation as one page that can be sent to somebody: HTML with everything it needs in it.
#pragma once

#include <string>
#include <vector>

#include "eval/ablation.hpp"
#include "eval/evaluation.hpp"

namespace vdna::report
{

// The page. No scripts, nothing fetched; pictures that cannot be read any more are said to be so.
// command_line: of the run, for whoever wants to repeat it.
std::string report_of(const eval::Evaluation &evaluation,
                      const std::vector<eval::Ablation> &ablations,
                      const std::string &command_line);

} // namespace vdna::report
