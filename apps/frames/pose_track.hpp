// The track of a robot that published its poses or GPS fixes, from the log of its drive.
#pragma once

#include <string>
#include <vector>

#include "frames/track.hpp"

namespace vdna::frames
{

// The messages of a channel, all of them bot_core.pose_t, whose positions are in the frame `local`,
// or all bot_core.gps_data_t. logs: the files of one drive. Throws Error.
Track read_pose_track(const std::vector<std::string> &logs, const std::string &channel,
                      const std::string &local, int64_t gap_us);

} // namespace vdna::frames
