// Choosing again while driving: how much is gained in drives whose look changes on the way.
#pragma once

#include <string>
#include <vector>

#include "eval/evaluation.hpp"

namespace vdna::eval
{

// drives: names of traversals joined by '+'. The first one is a query: its warmup is the drive's,
// and the others go on where it would be. One name alone is a drive whose look does not change.
// Throws Error.
Reselection choose_again(const Evaluation &evaluation, const std::vector<std::string> &drives);

} // namespace vdna::eval
