// The daemon's loop: newest camera frame in; choice, position and status out.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <vdna/cpp/backbone.hpp>
#include <vdna/cpp/experience_localiser.hpp>
#include <vdna/cpp/map.hpp>
#include <vdna/cpp/selector.hpp>
#include <vdna/health.h>
#include <vdna/transport.h>

#include "selectord/answer_file.hpp"
#include "selectord/backbone_process.hpp"
#include "selectord/config.hpp"
#include "selectord/limited_log.hpp"
#include "selectord/reports.hpp"
#include "selectord/resident_memory.hpp"
#include "selectord/stages.hpp"
#include "selectord/waiting.hpp"

namespace vdna::selectord
{

class Daemon
{
  public:
    // Allocates all memory of the loop; borrows all four. `process` is that of the backbone,
    // nullptr if it has none of its own. Throws Error.
    Daemon(const Config &config, const Map &map, const Backbone &backbone,
           BackboneProcess *process = nullptr);

    // Size of the largest message that run() publishes, in bytes.
    uint32_t message_size_max() const;

    // Bytes of the live histogram, of the localisers, and of everything else that this object holds
    // with the histogram.
    size_t histogram_size() const;
    size_t localisers_size() const;
    size_t size() const;

    // Also write answers to a file. Throws Error if it cannot be written.
    void keep_answers(const std::string &path);

    // Answer frames and commands until `stop`, or to the end of a log. Throws Error if the
    // connection is lost, or if a log is damaged or no frame of it could be used.
    void run(vdna_transport *transport, const std::atomic<bool> &stop);

  private:
    void beat(vdna_transport *transport);
    void overhear(vdna_transport *transport);
    void end_log(vdna_transport *transport) const;
    Facts facts(vdna_transport *transport) const;
    void reset();
    void answer(vdna_transport *transport, const vdna_transport_frame &frame,
                const std::atomic<bool> &stop);
    // Nothing for a late frame.
    std::optional<vdna_msg_localisation_t> use(vdna_transport *transport,
                                               const vdna_transport_frame &frame,
                                               const vdna_backbone_frame &seen, Stopwatch &watch);
    // Judge the picture. Returns why it is left out; "" if it is not.
    const char *fault_of(const vdna_backbone_frame &seen);
    // Note how an answer went, and mark it if the camera is degraded.
    void settle(vdna_msg_localisation_t &answer, vdna_status network);
    State state() const;
    vdna_msg_localisation_t place_of(const vdna_knn_match &match, int64_t utime) const;
    vdna_msg_localisation_t refuse(const vdna_transport_frame &frame, const char *reason);
    void announce_choice(vdna_transport *transport);
    Resident resident() const;
    void publish_status(vdna_transport *transport);
    void publish(vdna_transport *transport, const std::string &channel,
                 const vdna_message_type &type, const void *message);
    void keep(const std::string &channel, const vdna_message_type &type, const void *message);

    const Config &config_;
    const Map &map_;
    const Backbone &backbone_;
    BackboneProcess *const process_;
    const bool is_replay_; // frames come from a log, on which nothing can be sent
    const std::vector<std::unique_ptr<ExperienceLocaliser>> localisers_; // one for each experience
                                                                         // if the filter is on
    Selector selector_;                                                  // borrows them
    std::vector<float> projected_; // room for a live frame's embedding
    const Origin origin_;
    RankingReport ranking_; // borrows it
    ResidentMemory memory_;
    LimitedLog problems_, resets_, choices_;
    Waiting waiting_;
    Verdict verdict_; // of the last beat
    std::optional<AnswerFile> answers_;
    Stages stages_;
    vdna_health health_;
    std::array<char, 96> degraded_{}; // why the camera is degraded; "" if it is not
    bool network_failed_ = false;     // on the newest frame
    int32_t validity_ =
        VDNA_MSG_LOCALISATION_T_WARMING_UP; // of the newest answer that was no refusal
    int64_t used_us_ = 0;                   // when the newest frame was used; 0 = none yet
    uint64_t refused_ = 0, unusable_ = 0;
    std::array<char, sizeof(vdna_error::text)> refusal_{}; // why the newest of these was refused
    uint64_t localised_ = 0;
    uint64_t unanswered_ = 0; // frames skipped or late since the last answer
    uint32_t window_frames_max_ = 0;
};

} // namespace vdna::selectord
