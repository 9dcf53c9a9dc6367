// Length of the warmup: the first frames or seconds of a live source.
#pragma once

#include <string>

#include <vdna/cpp/selector.hpp>

namespace vdna::record
{

// "42" frames or "4.5s" of camera time, > 0. frames_min: fewest frames of a warmup by time. Throws
// Error.
Warmup warmup_of(const std::string &text, uint32_t frames_min = VDNA_WARMUP_FRAMES_MIN_DEFAULT);

} // namespace vdna::record
