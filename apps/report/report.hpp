// An evaluation as one self-contained HTML page.
#pragma once

#include <string>
#include <vector>

#include "eval/ablation.hpp"
#include "eval/evaluation.hpp"

namespace vdna::report
{

// The page has no scripts and fetches nothing; a note replaces pictures that cannot be read.
// command_line: of the run, so that it can be repeated.
std::string report_of(const eval::Evaluation &evaluation,
                      const std::vector<eval::Ablation> &ablations,
                      const std::string &command_line);

} // namespace vdna::report
