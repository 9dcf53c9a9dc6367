// The stages of a frame's way through the daemon, and their durations.
#pragma once

#include <chrono>

#include "selectord/durations.hpp"

namespace vdna::selectord
{

// Of all processed frames; docs/reference/SPEC-lcm.md defines the stages.
struct Stages {
    Durations queue, decode, resize, inference, select, rank, publish, total;
};

// Measures consecutive stages.
class Stopwatch
{
  public:
    // Microseconds since the last call or the construction.
    int64_t lap_us()
    {
        const Clock::time_point now = Clock::now();
        const auto lap = std::chrono::duration_cast<std::chrono::microseconds>(now - last_);
        last_ = now;
        return lap.count();
    }

  private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point last_ = Clock::now();
};

} // namespace vdna::selectord
