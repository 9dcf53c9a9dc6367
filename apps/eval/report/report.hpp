// An evaluation as one page that can be sent to somebody: HTML with everything it needs in it.
#pragma once

#include <string>
#include <vector>

#include "../ablation.hpp"
#include "../evaluation.hpp"

namespace vdna
{

// The page. No scripts, nothing fetched; pictures that cannot be read any more are said to be so.
// command_line: of the run, for whoever wants to repeat it.
std::string report_of(const Evaluation &evaluation, const std::vector<Ablation> &ablations,
                      const std::string &command_line);

} // namespace vdna
