// The daemon's loop: newest camera frame in; choice, position and status out.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include <vdna/cpp/backbone.hpp>
#include <vdna/cpp/map.hpp>
#include <vdna/cpp/selector.hpp>
#include <vdna/transport.h>

#include "selectord/config.hpp"
#include "selectord/problem_log.hpp"
#include "selectord/reports.hpp"
#include "selectord/resident_memory.hpp"
#include "selectord/stages.hpp"

namespace vdna::selectord
{

class Daemon
{
  public:
    // Allocates all memory of the loop; borrows all three. Throws Error.
    Daemon(const Config &config, const Map &map, const Backbone &backbone);

    // Size of the largest message that run() publishes, in bytes.
    uint32_t message_size_max() const;

    // Bytes of the live histogram, and of everything this object holds.
    size_t histogram_size() const;
    size_t size() const;

    // Answer frames and commands until `stop`. Throws Error if the connection is lost.
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

    const Config &config_;
    const Map &map_;
    const Backbone &backbone_;
    Selector selector_;
    RankingReport ranking_;
    ResidentMemory memory_;
    ProblemLog problems_;
    Stages stages_;
    uint64_t refused_ = 0;
    uint32_t window_frames_max_ = 0;
};

} // namespace vdna::selectord
