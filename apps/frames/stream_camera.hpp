// A camera that sends its video over the network, by RTSP or HTTP.
#pragma once

#include <memory>
#include <string>

#include "frames/camera.hpp"

namespace vdna::frames
{

// Receive a stream and decode it (OpenCV, FFmpeg). A frame's utime is when it arrived: streams do
// not say when it was taken. The camera is lost if the stream ends or nothing comes for five
// seconds. Throws Error.
std::unique_ptr<Camera> open_stream_camera(const std::string &url);

} // namespace vdna::frames
