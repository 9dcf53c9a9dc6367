// A drive that is going on: camera frames and poses as they come over LCM.
#pragma once

#include <cstdint>
#include <string>

#include <vdna/camera_time.h>
#include <vdna/cpp/connection.hpp>
#include <vdna/cpp/listener.hpp>

#include "frames/pose_track.hpp"
#include "frames/source.hpp"

namespace vdna::frames
{

struct LiveOptions {
    std::string url; // LCM network; "" = LCM's default
    std::string camera = VDNA_CHANNEL_CAMERA;
    std::string pose_channel;                        // "" = none
    std::string local_frame = VDNA_FRAME_LOCAL;      // of positions in bot_core.pose_t
    uint32_t time_unit = VDNA_TIME_UNIT_AUTO;        // of camera stamps
    double late_s = VDNA_TIME_LATE_US_DEFAULT / 1e6; // as in SourceOptions
};

// What came, and what did not become a frame.
struct LiveCounts {
    uint64_t received = 0;  // camera messages, skipped ones included
    uint64_t skipped = 0;   // by us: newer ones came while we were busy, or they were too large
    uint64_t lost = 0;      // on the network, as far as their sender numbers them
    uint64_t rejected = 0;  // broken, or damaged on the way
    uint64_t late = 0;      // older than a frame before them
    uint64_t backwards = 0; // steps back of camera time
};

class Live
{
  public:
    // Connect and subscribe. Throws Error.
    explicit Live(const LiveOptions &options);

    // The newest frame, without a label; false if none came within a moment, or it is late. Of a
    // log each frame comes.
    // If the network is gone, has_ended() tells.
    bool next(Frame &out_frame);
    // True from the frame on that showed its stamps, and those of all before it, not to be
    // microseconds, until the next one.
    bool has_recognised_unit() const { return order_ == VDNA_TIME_RECOGNISED; }
    uint32_t time_unit() const { return time_.unit; }
    // No frame will come any more: a log has ended, or the network is gone.
    bool has_ended() const { return has_ended_; }

    // Take a message of the pose channel; false if there is none. timeout_ms: how long to wait for
    // it. One of another type than those before it is left out and told once.
    bool take_pose(int32_t timeout_ms = 0);
    // No pose will come any more.
    bool poses_have_ended() const { return !listener_ || poses_ended_; }
    bool has_poses() const { return listener_ != nullptr; }
    Poses &poses() { return poses_; }

    // Counts begin here, not with the connection.
    void begin_counting();
    LiveCounts counts() const;
    // Most memory of the connections, in bytes.
    uint64_t memory_bytes() const;
    bool is_log() const { return is_log_; }

  private:
    LiveOptions options_;
    bool is_log_;
    Connection connection_;
    Listener listener_; // NULL without a pose channel
    Poses poses_;
    vdna_transport_counters before_{}; // when counting began
    vdna_camera_time time_;
    uint32_t order_ = VDNA_TIME_IN_ORDER; // of the newest frame
    uint64_t frames_ = 0;
    uint32_t refusals_ = 0; // since the last pose or fix
    bool has_ended_ = false, poses_ended_ = false;
};

} // namespace vdna::frames
