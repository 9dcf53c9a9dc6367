// Records a drive that is going on, in memory of a stated size.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include <vdna/health.h>

#include "frames/live.hpp"
#include "record/maker.hpp"

namespace vdna::record
{

struct LiveLimits {
    uint32_t frames_max = 12000; // >= 1
    double seconds = 0;          // by the clock; 0 = no limit
    double interval_s = 0;       // of camera time between two frames that are kept, at least
};

// Why a recording ended.
enum class LiveEnd { interrupted, time, full, log, network };

class LiveRecorder
{
  public:
    // maker: with ranges. These three are borrowed. frame: in which positions must be; "" = any.
    LiveRecorder(Maker &maker, Backbone &backbone, frames::Live &live, const LiveLimits &limits,
                 std::string frame);

    // Most memory that record() and label() take, in bytes.
    uint64_t memory_bytes() const;
    // Make all that room. Throws Error.
    void begin(Draft &draft);
    // Add usable frames until something ends it: Ctrl-C is one way.
    LiveEnd record(Draft &draft);
    // Give the frames positions by the poses that came. These are waited for until they are as new
    // as the frames, at most some seconds. What prevents it is told: the frames have none then.
    // gap_s: as in frames::SourceOptions.
    void label(Draft &draft, double gap_s);

    uint64_t unusable() const { return unusable_; }
    // Of these, by VDNA_HEALTH_...; [VDNA_HEALTH_OK] are those that the network cannot read.
    const std::array<uint64_t, VDNA_HEALTH_COUNT> &verdicts() const { return verdicts_; }
    // Frames that came sooner than the interval after the one kept before.
    uint64_t between() const { return between_; }

  private:
    void take(Draft &draft, frames::Frame &frame);
    void take_poses(const Draft &draft);
    bool take_pose(const Draft &draft, int32_t timeout_ms);
    bool is_in_frame(const frames::Poses &poses) const;
    std::string other_frame(const frames::Poses &poses) const;
    void await_poses(const Draft &draft);

    Maker &maker_;
    Backbone &backbone_;
    frames::Live &live_;
    LiveLimits limits_;
    std::string frame_;
    vdna_health health_;
    std::array<uint64_t, VDNA_HEALTH_COUNT> verdicts_{};
    uint64_t unusable_ = 0, between_ = 0;
};

} // namespace vdna::record
