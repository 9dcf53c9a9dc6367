#include "selectord/standby.hpp"

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <utility>

namespace vdna::selectord
{

namespace
{

constexpr int64_t silence_us = 3000000; // of statuses, which come once a second: it is gone

} // namespace

// Whoever stands by is outranked by everybody who serves.
bool Standby::outranks_us(const vdna_transport_peer &peer) const
{
    return stands_by() ||
           std::pair(peer.serving_utime, peer.instance) < std::pair(serving_utime_, instance_);
}

void Standby::stand_by_for(const vdna_transport_peer &peer)
{
    serving_utime_ = 0;
    std::snprintf(reason_.data(), reason_.size(),
                  "the daemon on %s (instance %" PRId64
                  ") answers on these channels; this one follows 3 s after it falls silent",
                  peer.host, peer.instance);
}

bool Standby::judge(const vdna_transport_peer *peers, uint32_t count, int64_t now_us,
                    int64_t wall_us)
{
    const bool stood_by = stands_by();
    const vdna_transport_peer *first = nullptr;
    for (const vdna_transport_peer *peer = peers; peer != peers + count; peer++) {
        if (peer->instance == instance_ || peer->serving_utime == 0 ||
            now_us - peer->received_us >= silence_us)
            continue;
        if (outranks_us(*peer))
            first = peer;
        else
            newcomer_ = peer->instance;
    }
    if (first)
        stand_by_for(*first);
    else if (stood_by) {
        serving_utime_ = wall_us;
        reason_[0] = '\0';
    }
    return stood_by != stands_by();
}

bool Standby::has_newcomer()
{
    return !stands_by() && std::exchange(told_, newcomer_) != newcomer_;
}

} // namespace vdna::selectord
