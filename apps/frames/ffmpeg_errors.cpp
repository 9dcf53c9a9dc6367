#include "frames/ffmpeg_errors.hpp"

#include <cstdarg>
#include <mutex>
#include <utility>

extern "C" {
#include <libavutil/log.h>
}

namespace vdna::frames
{

namespace
{

// FFmpeg calls back from its decoding threads.
std::mutex mutex;
std::string last_error; // guarded by mutex

void keep(void *context, int level, const char *format, va_list arguments)
{
    if (level > AV_LOG_ERROR)
        return;
    char line[256];
    int begins_line = 1;
    av_log_format_line2(context, level, format, arguments, line, sizeof line, &begins_line);
    std::string text = line;
    // "[h264 @ 0x55ea76ad6740] sentence\n": the address says nothing to people.
    text.erase(0, text.rfind("] ") == std::string::npos ? 0 : text.rfind("] ") + 2);
    text.erase(text.find_last_not_of('\n') + 1);
    const std::lock_guard lock(mutex);
    last_error = text;
}

} // namespace

void collect_ffmpeg_errors()
{
    av_log_set_callback(keep);
}

std::string take_ffmpeg_error()
{
    const std::lock_guard lock(mutex);
    return std::exchange(last_error, "");
}

} // namespace vdna::frames
