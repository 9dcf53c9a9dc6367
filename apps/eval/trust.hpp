// Trust in the choice, tried on the queries of an evaluation.
#pragma once

#include "eval/binning.hpp"
#include "eval/evaluation.hpp"

namespace vdna::eval
{

// Numbers of references of the maps that are tried besides all, and the most maps of each that are
// drawn for a query.
constexpr uint32_t trust_references[] = {3, 4};
constexpr size_t trust_maps_most = 20;

// evaluation: of these frames and in these bins. Shows progress. Throws Error.
TrustEvaluation evaluate_trust(Frames &frames, Binning &binning, const Evaluation &evaluation);

} // namespace vdna::eval
