// A camera that is running now.
#pragma once

#include <cstdint>
#include <string>

#include "frames/source.hpp"

namespace vdna::frames
{

// What a camera lost since it was opened.
struct CameraLosses {
    uint64_t dropped = 0; // frames that its driver could not deliver, by their numbers
    uint64_t damaged = 0; // frames that arrived incomplete, which read() leaves out
};

class Camera
{
  public:
    virtual ~Camera() = default;
    // Wait for the next frame, stamped in microseconds since 1970; false after Ctrl-C or at the end
    // of a file. Throws Error if the camera is lost.
    virtual bool read(Frame &out_frame) = 0;
    // For people: "HD Webcam: 1280x720 MJPG, 30 Hz".
    virtual std::string description() const = 0;
    virtual CameraLosses losses() const { return {}; }
};

} // namespace vdna::frames
