// Lines that may come as often as frames or commands: keeps the last one, and prints at most one a
// second on standard error.
#pragma once

#include <array>
#include <cstdint>

namespace vdna::selectord
{

class LimitedLog
{
  public:
    // printf-like; `now_us` is monotonic.
    [[gnu::format(printf, 3, 4)]] void note(int64_t now_us, const char *format, ...);

    // The last line; "" if there was none.
    const char *last() const { return last_.data(); }

  private:
    std::array<char, 512> last_{};
    int64_t quiet_until_us_ = 0;
    uint64_t unprinted_ = 0; // since the last line
};

} // namespace vdna::selectord
