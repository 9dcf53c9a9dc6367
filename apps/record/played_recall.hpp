// How well a stored run would be localised, if it were the live one.
#pragma once

#include <vdna/map.h>

namespace vdna::record
{

// Share of frames, 0..1, whose nearest frame in the candidate is good, as a robot finds it: after a
// warmup of the first two fifths of the run, at most 100 frames, about a mean that goes on with the
// drive. NaN if no frame after the warmup has a label to judge it by.
// tolerance: metres or place numbers. Throws Error.
double played_recall(const vdna_experience &run, const vdna_experience &candidate,
                     double tolerance);

} // namespace vdna::record
