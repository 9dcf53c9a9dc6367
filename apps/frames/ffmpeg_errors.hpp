// What FFmpeg complains of while OpenCV reads a video. OpenCV has no other way to tell that a
// picture was damaged: FFmpeg conceals the damage and hands the picture out.
#pragma once

#include <cstdint>
#include <string>

namespace vdna::frames
{

// Collect FFmpeg's errors instead of printing them, from now on and in the whole process.
void collect_ffmpeg_errors();

// The last error since the previous call; "" if there was none.
std::string take_ffmpeg_error();

} // namespace vdna::frames
