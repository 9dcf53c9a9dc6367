// Length of the warmup: the first frames or seconds of a live source.
#pragma once

#include <string>

#include <vdna/cpp/selector.hpp>

namespace vdna::record
{

// "42" frames or "4.5s" of camera time, > 0. Throws Error.
Warmup warmup_of(const std::string &text);

} // namespace vdna::record
