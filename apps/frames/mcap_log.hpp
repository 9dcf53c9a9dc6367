// Camera frames and positions of MCAP files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "frames/track.hpp"

namespace vdna::frames
{

// The track of the positions on a topic: foxglove.LocationFix, or sensor_msgs' NavSatFix. files: of
// one drive, in their order. Fixes further apart than `gap_us` are not joined. Throws Error.
Track read_mcap_track(const std::vector<std::string> &files, const std::string &topic,
                      int64_t gap_us);

} // namespace vdna::frames
