// Pictures and positions in the messages of MCAP files: Foxglove's and ROS's types.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "frames/mcap_file.hpp"

namespace vdna::frames
{

// The kinds of messages that are read.
enum class McapKind { other, picture, fix };

// Of foxglove.CompressedImage and LocationFix (protobuf, JSON, ROS) and of sensor_msgs'
// CompressedImage and NavSatFix (ROS 1 and 2).
McapKind kind_of(const McapChannel &channel);

// What a message holds; of a picture its bytes, of a fix the rest.
struct McapContent {
    int64_t utime = 0;            // microseconds; 0 = not stamped
    std::vector<uint8_t> encoded; // JPEG, PNG ...
    bool has_fix = true;
    double lat = 0, lon = 0, alt = 0; // WGS84 degrees and metres, not checked
};

// False if the message is damaged, or of kind McapKind::other.
bool read_content(const McapMessage &message, McapContent &out_content);

} // namespace vdna::frames
