// The daemon's messages, filled from plain state. They borrow their texts from the map, so that
// filling one allocates nothing.
#pragma once

#include <string>
#include <vector>

#include <vdna_msg_localisation_t.h>
#include <vdna_msg_ranking_t.h>
#include <vdna_msg_status_t.h>

#include <vdna/cpp/explainer.hpp>
#include <vdna/cpp/map.hpp>
#include <vdna/cpp/trust.hpp>
#include <vdna/transport.h>

#include "program/choice_sentence.hpp"
#include "selectord/resident_memory.hpp"
#include "selectord/stages.hpp"

namespace vdna::selectord
{

// Which process this is.
struct ProcessId {
    int64_t instance; // random
    std::string host; // name of the machine; "" if the system does not tell
    std::string boot; // of the machine's start; "" if the system does not tell
};

// Draws the instance, and asks the system for the rest.
ProcessId identify_process();

// The choice: the ranking message with room for all experiences of a map, and what to expect.
class RankingReport
{
  public:
    // Borrows from all. warmup_frames: 0 = not known
    RankingReport(const Map &map, const vdna_backbone_info &backbone, const std::string &map_hash,
                  const Trust &trust, uint32_t warmup_frames);

    // Most bytes of the message on the wire.
    uint32_t encoded_size() const;
    // Bytes that it holds besides itself.
    size_t memory_size() const;

    // Find the neurons that tell the first of the ranking from the second; `select` has just made
    // a choice.
    void explain(const vdna_select &select);
    // Valid until the next call; `select` has a choice, which explain() has seen.
    // is_switch: that replaces another while driving; otherwise a warmup brought it
    const vdna_msg_ranking_t &fill(const vdna_select &select, bool is_switch);
    // The newest of them for those who listen later; `select` still has that choice.
    const vdna_msg_ranking_t &repeat();
    // The same of the newest one's window, after a command.
    const vdna_msg_ranking_t &fill_again(const vdna_select &select);

    // What the newest says of the choice, in a sentence; "" before the first.
    const char *sentence() const { return sentence_.data(); }
    // What it lets expect of a candidate; nullptr if it does not know: during a warmup, and after a
    // switch, because the warmup said otherwise.
    const vdna_trust_prediction *prediction(const vdna_select &select, uint32_t candidate) const;
    // As in ranking_t.
    double skill() const { return message_.skill; }
    int32_t settled_frames(const vdna_select &select) const;

  private:
    void fill_trust(const vdna_select &select);
    void fill_sentence(const vdna_select &select);
    void lay_out_reasons();
    void fill_reason(size_t at, const Reason &reason);
    void fill_entry(const vdna_select &select, size_t at, const vdna_rank_entry &entry);

    const Trust &trust_;
    const int warmup_frames_;
    bool is_switch_ = false; // of the newest choice
    program::Sentence sentence_{};
    const std::vector<vdna_experience> &experiences_;
    std::vector<char *> names_;
    std::vector<double> distances_;
    std::vector<int8_t> tied_, bound_;
    std::vector<double> recalls_, lows_, highs_, transfers_;
    Explainer explainer_;
    std::vector<char *> reason_taps_;
    std::vector<int32_t> reason_neurons_, winner_most_, winner_least_, runner_up_most_,
        runner_up_least_;
    std::vector<double> reason_bins_, live_bins_, winner_bins_, runner_up_bins_;
    vdna_msg_ranking_t message_{};
};

// An answer without a position; `validity` is WARMING_UP or REFUSED. Borrows the reason.
vdna_msg_localisation_t no_position(int64_t utime, int32_t validity, const char *reason = "");

// The nearest frame of an experience, which is VALID; borrows the texts from it.
vdna_msg_localisation_t nearest_in(const vdna_experience &map, const vdna_knn_match &match,
                                   int64_t utime);

// The place in an experience by its filter, UNSURE if the confidence is lower than
// `min_confidence`; borrows the texts from it.
vdna_msg_localisation_t position_in(const vdna_experience &map, const vdna_localise_answer &answer,
                                    double min_confidence, int64_t utime);

// Add what to expect; nullptr is not known.
void expect(const vdna_trust_prediction *prediction, vdna_msg_localisation_t &message);

// What the daemon is worth now.
struct State {
    int32_t state; // VDNA_MSG_STATUS_T_...
    const char *reason;
    int64_t frame_age_us;
};

// What became of frames since the start of the daemon.
struct FrameCounts {
    uint64_t accepted = 0, late = 0;
    uint64_t restarts = 0; // warmups begun anew because of them
    uint64_t switches = 0; // to another choice while driving
};

// The contents of a status message.
struct StatusFacts {
    const ProcessId &process;
    int64_t serving_utime; // 0 = standing by
    State state;
    const vdna_select &select;
    const RankingReport &ranking;
    const vdna_transport_counters &transport;
    const std::vector<vdna_experience> &experiences;
    size_t left_out; // experiences
    const std::string &map_hash;
    bool map_changed;
    std::vector<char *> &excluded; // names
    const vdna_backbone_info &backbone;
    const Stages &stages;
    FrameCounts counts;
    uint64_t refused, unusable, stood_by; // frames
    uint64_t parked, carried, over_rate;  // frames
    uint32_t window_frames_max;
    Resident resident;
    const char *message;
};

// Upper bound for the wire size of a status or localisation, bytes.
constexpr uint32_t other_messages_size_max = 4096;

// Borrows its texts from `facts`; `utime` is in microseconds since 1970.
vdna_msg_status_t status_of(const StatusFacts &facts, int64_t utime);

} // namespace vdna::selectord
