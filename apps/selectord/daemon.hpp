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
#include <vdna/cpp/map.hpp>
#include <vdna/health.h>
#include <vdna/parked.h>
#include <vdna/transport.h>

#include "selectord/answer_file.hpp"
#include "selectord/backbone_process.hpp"
#include "selectord/config.hpp"
#include "selectord/glance.hpp"
#include "selectord/limited_log.hpp"
#include "selectord/map_reload.hpp"
#include "selectord/map_session.hpp"
#include "selectord/operator_commands.hpp"
#include "selectord/pace.hpp"
#include "selectord/reports.hpp"
#include "selectord/resident_memory.hpp"
#include "selectord/service_manager.hpp"
#include "selectord/stages.hpp"
#include "selectord/standby.hpp"
#include "selectord/waiting.hpp"

namespace vdna::selectord
{

class Daemon
{
  public:
    // Allocates all memory of the loop; borrows all but the map. `process` is that of the backbone,
    // nullptr if it has none of its own. Throws Error.
    Daemon(const Config &config, OpenedMap map, const Backbone &backbone,
           BackboneProcess *process = nullptr);

    // Size of the largest message that run() publishes, in bytes, whatever a reload brings.
    uint32_t message_size_max() const { return message_size_max_; }

    const MapSession &session() const { return *session_; }
    // Bytes of the live histogram and of everything else that this object holds, but the map, what
    // is decoded from it and the localisers.
    size_t size() const;

    // Also write answers to a file. Throws Error if it cannot be written.
    void keep_answers(const std::string &path);

    // Open the map's directory again whenever `requested` is set, in any thread; it is borrowed.
    // A reload for which `held_bytes`, of everything but maps, and both maps exceed the budget is
    // refused.
    void reload_when(std::atomic<bool> &requested, uint64_t held_bytes);

    // Answer frames and commands until `stop`, or to the end of a log, and tell `manager` about it.
    // Throws Error if the connection is lost, or if a log is damaged or no frame of it could be
    // used.
    void run(vdna_transport *transport, const std::atomic<bool> &stop,
             const ServiceManager &manager);

  private:
    void beat(vdna_transport *transport, const ServiceManager &manager);
    void judge_peers(vdna_transport *transport);
    bool network_makes_progress();
    void overhear(vdna_transport *transport);
    void end_log(vdna_transport *transport) const;
    Facts facts(vdna_transport *transport) const;
    void take_commands(vdna_transport *transport);
    Outcome take(vdna_transport *transport, const vdna_transport_command &command);
    Outcome reset();
    Outcome change_choice(vdna_transport *transport, const vdna_transport_command &command);
    void answer_command(vdna_transport *transport, int64_t utime, int32_t command,
                        const Outcome &outcome);
    void forget();
    void go_on_reloading(vdna_transport *transport, const ServiceManager &manager);
    Outcome end_reload(std::unique_ptr<MapSession> next);
    void keep_to_settings();
    void answer(vdna_transport *transport, const vdna_transport_frame &frame,
                const std::atomic<bool> &stop);
    // Nothing for a late frame.
    std::optional<vdna_msg_localisation_t> use(vdna_transport *transport,
                                               const vdna_transport_frame &frame,
                                               const vdna_backbone_frame &seen, Stopwatch &watch);
    // Whether the camera still sees what it saw in the newest frame. `out_looked`: whether the
    // picture was compared at all.
    bool is_parked(const vdna_transport_frame &frame, bool &out_looked);
    bool may_be_parked() const;
    bool is_look_due();
    int64_t time_of(const vdna_transport_frame &frame) const;
    void repeat(vdna_transport *transport, const vdna_transport_frame &frame, int32_t basis);
    // Remember what later frames may be answered from.
    void remember(const vdna_msg_localisation_t &answer, const vdna_transport_frame &frame,
                  bool looked);
    // Judge the picture. Returns why it is left out; "" if it is not.
    const char *fault_of(const vdna_backbone_frame &seen);
    void note_used(const vdna_msg_localisation_t &answer);
    void mark_degraded(vdna_msg_localisation_t &answer) const;
    void send(vdna_transport *transport, const vdna_transport_frame &frame,
              vdna_msg_localisation_t answer);
    State state();
    vdna_msg_localisation_t place_of(const vdna_knn_match &match, int64_t utime) const;
    // The place, and what it is worth by what is known about the choice.
    vdna_msg_localisation_t trusted_place_of(const vdna_knn_match &match, int64_t utime) const;
    vdna_msg_localisation_t refuse(const vdna_transport_frame &frame, const char *reason,
                                   int32_t validity = VDNA_MSG_LOCALISATION_T_REFUSED);
    void announce_choice(vdna_transport *transport, const vdna_msg_ranking_t &ranking);
    Resident resident() const;
    const char *problem() const;
    void publish_status(vdna_transport *transport);
    void repeat_choice(vdna_transport *transport);
    // Write to the file of answers, and send.
    void publish(vdna_transport *transport, const std::string &channel,
                 const vdna_message_type &type, const void *message);
    void send(vdna_transport *transport, const std::string &channel, const vdna_message_type &type,
              const void *message);
    void keep(const std::string &channel, const vdna_message_type &type, const void *message);

    const Config &config_;
    const Backbone &backbone_;
    BackboneProcess *const process_;
    const bool is_replay_; // frames come from a log, on which nothing can be sent
    const ProcessId process_id_;
    std::unique_ptr<MapSession> session_;
    const uint32_t message_size_max_;
    std::optional<MapReload> reload_;
    bool map_is_old_ = false;     // the newest reload failed
    bool map_is_changed_ = false; // the directory, at the last beat
    ResidentMemory memory_;
    LimitedLog problems_, commands_, choices_, reloads_, reload_problems_;
    Waiting waiting_;
    Verdict verdict_; // of the last beat
    std::optional<AnswerFile> answers_;
    Stages stages_;
    uint32_t network_runs_ = 0, network_answers_ = 0; // since the last beat
    vdna_health health_;
    RateLimit rate_limit_;
    uint64_t over_rate_ = 0; // frames
    // The answer to the newest frame, if that went through the network and nothing has changed
    // since; what it borrows lasts as long.
    std::optional<vdna_msg_localisation_t> newest_;
    int64_t newest_stamp_ = 0;     // of the newest frame that was answered from it, or its own
    std::optional<Glance> glance_; // none if the network's process looks, or nobody does
    vdna_parked parked_;
    bool has_newest_look_ = false; // the reference is the newest frame
    uint32_t misses_ = 0;          // looks since the newest that was like the reference
    uint32_t unlooked_ = 0;        // frames since the newest look
    uint64_t parked_frames_ = 0;
    Stride stride_;
    uint64_t carried_ = 0;            // frames
    std::array<char, 96> degraded_{}; // why the camera is degraded; "" if it is not
    bool network_failed_ = false;     // on the newest frame
    int32_t validity_ =
        VDNA_MSG_LOCALISATION_T_WARMING_UP; // of the newest answer that was no refusal
    int64_t used_us_ = 0;                   // when the newest frame was used; 0 = none yet
    uint64_t refused_ = 0, unusable_ = 0;
    std::array<char, sizeof(vdna_error::text)> refusal_{}; // why the newest of these was refused
    Standby standby_;
    uint64_t stood_by_ = 0; // frames
    uint64_t localised_ = 0;
    uint64_t unanswered_ = 0; // frames skipped or late since the last answer
    uint32_t window_frames_max_ = 0;
    std::vector<char *> excluded_; // of the newest status
};

} // namespace vdna::selectord
