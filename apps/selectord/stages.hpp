// The way of a frame through the daemon, and how long each stage of it takes.
#pragma once

#include <chrono>

#include "selectord/durations.hpp"

namespace vdna::selectord
{

// Of all frames that were used; what each stage is: docs/reference/SPEC-lcm.md.
struct Stages {
    Durations queue, decode, resize, inference, select, rank, publish, total;
};

// Measures one stage after the other.
class Stopwatch
{
  public:
    // Microseconds since the last call or the beginning.
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
