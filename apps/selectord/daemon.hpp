// The daemon's loop: newest camera frame in; choice, position and health out.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include <vdna/transport.h>

#include "pairing/pairing.hpp"
#include "selectord/config.hpp"
#include "selectord/problem_log.hpp"
#include "selectord/reports.hpp"
#include "selectord/resident_memory.hpp"
#include "selectord/stages.hpp"

namespace vdna
{

class Daemon
{
  public:
    // Allocates all that the loop needs; borrows the map and the backbone. Throws Error.
    Daemon(const Config &config, const Map &map, const Backbone &backbone);

    // Bytes of the largest message that run() publishes.
    uint32_t message_size_max() const;

    // Bytes of the live histogram, and of all that this object holds.
    size_t histogram_size() const;
    size_t size() const;

    // Answer frames and commands until `stop`. Throws Error if the connection is gone.
    void run(vdna_transport *transport, const std::atomic<bool> &stop);

  private:
    void reset();
    void answer(vdna_transport *transport, const vdna_transport_frame &frame,
                const std::atomic<bool> &stop);
    vdna_msg_localisation_t use(vdna_transport *transport, const vdna_transport_frame &frame,
                                const vdna_backbone_frame &seen, Stopwatch &watch);
    vdna_msg_localisation_t refuse(const vdna_transport_frame &frame, const char *reason);
    void announce_choice(vdna_transport *transport);
    void publish_status(vdna_transport *transport);
    void note_unless_sent(vdna_status sent, const char *what);

    const Map &map_;
    const Backbone &backbone_;
    std::vector<vdna_select_candidate> candidates_;
    std::vector<int64_t> selector_memory_; // int64_t for its alignment
    vdna_select *select_ = nullptr;        // in selector_memory_
    RankingReport ranking_;
    ResidentMemory memory_;
    ProblemLog problems_;
    Stages stages_;
    uint64_t refused_ = 0;
    uint32_t window_frames_max_ = 0;
};

} // namespace vdna
