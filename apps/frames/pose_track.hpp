// The track of a robot that published its poses or GPS fixes, live or in the log of its drive.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <vdna/message.h>

#include "frames/track.hpp"

namespace vdna::frames
{

// The messages of one channel: all of them bot_core.pose_t, or all bot_core.gps_data_t.
class Poses
{
  public:
    // local: the frame of positions in bot_core.pose_t
    explicit Poses(std::string local) : local_(std::move(local)) {}

    // Take a message, decoded, as the struct that lcm-gen declares for `type`, which is one of
    // these two; false if those before it are of the other. One without a position is counted only.
    bool take(const vdna_message_type &type, const void *message);

    // Of all of them; NULL before the first.
    const vdna_message_type *type() const { return type_; }
    // The frame of their positions; "" before the first.
    std::string frame() const;
    // The newest time of a position, microseconds; INT64_MIN before the first.
    int64_t newest_utime() const { return newest_utime_; }
    // Positions held.
    size_t size() const { return points_.size() + fixes_.fixes.size(); }
    // Make room, so that no more is allocated up to this many.
    void reserve(size_t positions);
    // Drop the positions that no frame lies next to, except the newest ones: frames to come may
    // need these. utimes: of the frames so far; newest: >= 1.
    void thin(const std::vector<int64_t> &utimes, size_t newest);

    // name: for complaints. Throws Error, also if no position can be used.
    Track track(const std::string &name, int64_t gap_us) const;

  private:
    std::string local_;
    const vdna_message_type *type_ = nullptr;
    int64_t newest_utime_ = std::numeric_limits<int64_t>::min();
    std::vector<Track::Point> points_; // of poses
    TrackFile fixes_;                  // of GPS; its count of unplaced ones for both
};

// The messages of a channel, as Poses takes them, whose positions are in the frame `local`. logs:
// the files of one drive. Throws Error.
Track read_pose_track(const std::vector<std::string> &logs, const std::string &channel,
                      const std::string &local, int64_t gap_us);

} // namespace vdna::frames
