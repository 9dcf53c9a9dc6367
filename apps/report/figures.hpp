// Every figure of the report, as files.
#pragma once

#include <string>

#include "eval/evaluation.hpp"

namespace vdna::report
{

// Writes NAME.svg and NAME.pdf of each figure into a directory, created if missing. Reads picture
// files. Throws Error.
void write_figures(const eval::Evaluation &evaluation, const std::string &directory);

} // namespace vdna::report
