// A recording that passes for a running camera.
#pragma once

#include <memory>
#include <string>

#include "frames/camera.hpp"

namespace vdna::frames
{

// Frames come when they did in the recording, by its own times, and are stamped with the time at
// which they come. Throws Error.
std::unique_ptr<Camera> open_file_camera(const std::string &path);

} // namespace vdna::frames
