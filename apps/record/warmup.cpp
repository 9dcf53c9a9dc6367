#include "record/warmup.hpp"

#include <charconv>

#include <vdna/cpp/error.hpp>

#include "program/exit_code.hpp"

namespace vdna::record
{

Warmup warmup_of(const std::string &text, uint32_t frames_min)
{
    const char *end = text.data() + text.size();
    uint32_t frames = 0;
    const auto as_frames = std::from_chars(text.data(), end, frames);
    if (as_frames.ec == std::errc() && as_frames.ptr == end && frames > 0)
        return {frames, 0, frames_min};
    double seconds = 0;
    const auto as_time = std::from_chars(text.data(), end, seconds);
    if (as_time.ec != std::errc() || std::string(as_time.ptr, end) != "s" ||
        !(seconds >= warmup_seconds_min && seconds <= warmup_seconds_max))
        throw program::UsageError(
            "--warmup: found '" + text +
            "', expected frames as 42 or seconds of camera time as 4.5s, from 0.001 to 1000000");
    return {0, static_cast<int64_t>(seconds * 1e6), frames_min};
}

} // namespace vdna::record
