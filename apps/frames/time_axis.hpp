// Times of frames: stamps in whatever unit become microseconds, and late frames are told.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <vdna/camera_time.h>

#include "frames/account.hpp"

namespace vdna::frames
{

class TimeAxis
{
  public:
    // stamps: those known beforehand, in the order of the frames, from which the unit is
    // recognised; without any, times are microseconds. unit: VDNA_TIME_UNIT_...
    TimeAxis(const std::vector<int64_t> &stamps, uint32_t unit, int64_t late_us);

    // The time of the next frame in microseconds; nothing if the frame is late.
    std::optional<int64_t> take(int64_t stamp);

    // Fill in unit, late frames and notes.
    void describe(Account &account) const;

  private:
    std::vector<std::string> notes_;
    bool has_stamps_;
    uint64_t frames_ = 0;
    vdna_camera_time time_;
};

} // namespace vdna::frames
