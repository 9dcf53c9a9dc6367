#include "selectord/limited_log.hpp"

#include <cinttypes>
#include <cstdarg>
#include <cstdio>

namespace vdna::selectord
{

void LimitedLog::note(int64_t now_us, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(last_.data(), last_.size(), format, arguments);
    va_end(arguments);

    if (now_us < quiet_until_us_) {
        unprinted_++;
        return;
    }
    std::fprintf(stderr, "vdna_selectord: %s", last_.data());
    if (unprinted_ > 0)
        std::fprintf(stderr, " (and %" PRIu64 " more lines like it before)", unprinted_);
    std::fputc('\n', stderr);
    quiet_until_us_ = now_us + 1000000;
    unprinted_ = 0;
}

} // namespace vdna::selectord
