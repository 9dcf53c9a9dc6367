// How long the warmup is: the first frames or seconds of a live source.
#pragma once

#include <cstdint>
#include <string>

namespace vdna
{

// One of the two is 0.
struct Warmup {
    uint32_t frames;
    int64_t us; // of camera time
};

// "42" frames or "4.5s" of camera time, more than nothing. Throws Error.
Warmup warmup_of(const std::string &text);

} // namespace vdna
