// Which of several daemons on the same channels answers frames: the one that has for longest, by
// the clocks of their machines, and if two began in the same microsecond the one with the smaller
// instance. All judge alike by what each status says, so they agree once each has heard the others.
#pragma once

#include <array>
#include <cstdint>

#include <vdna/transport.h>

namespace vdna::selectord
{

class Standby
{
  public:
    // `instance`: of this process. It serves since `wall_us`, microseconds since 1970.
    Standby(int64_t instance, int64_t wall_us) : instance_(instance), serving_utime_(wall_us) {}

    // Judge by the daemons heard so far. Returns whether we begin to serve or to stand by.
    // `now_us` is monotonic.
    bool judge(const vdna_transport_peer *peers, uint32_t count, int64_t now_us, int64_t wall_us);

    bool stands_by() const { return serving_utime_ == 0; }
    // Microseconds since 1970; 0 = it stands by.
    int64_t serving_utime() const { return serving_utime_; }
    // Who serves in our place; "" if nobody does.
    const char *reason() const { return reason_.data(); }

    // Whether a daemon has come that does not know yet that we serve: tell it. Once for each.
    bool has_newcomer();

  private:
    bool outranks_us(const vdna_transport_peer &peer) const;
    void stand_by_for(const vdna_transport_peer &peer);

    const int64_t instance_;
    int64_t serving_utime_;
    int64_t newcomer_ = 0, told_ = 0; // instances: the newest that we outrank, and the last told
    std::array<char, 192> reason_{};
};

} // namespace vdna::selectord
