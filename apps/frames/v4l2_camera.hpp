// A camera of Linux (V4L2): its frames as its driver gives them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "frames/camera.hpp"
#include "frames/device_calls.hpp"

namespace vdna::frames
{

// What is asked of the camera.
struct V4l2Settings {
    uint32_t width = 0, height = 0; // pixels; 0 = as the driver has it set
    double rate_hz = 0;             // 0 = as the driver has it set
    std::string format;             // one of v4l2_formats(); "" = the first that it offers
};

// The formats that can be sent as bot_core.image_t, the preferred one first: "MJPG", ...
std::vector<std::string> v4l2_formats();

// Open a camera and let it run. The data of a frame are the driver's own buffer until the next
// read. A frame's utime is when the driver stamped it, and changes with the system's clock. calls:
// borrowed. Throws Error, also if the camera cannot do exactly what is asked.
std::unique_ptr<Camera> open_v4l2_camera(const std::string &path, const V4l2Settings &settings,
                                         DeviceCalls &calls);

} // namespace vdna::frames
