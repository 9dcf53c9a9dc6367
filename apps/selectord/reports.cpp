#include "selectord/reports.hpp"

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>
#include <random>

#include <unistd.h>

#include <vdna/cpp/selector.hpp>
#include <vdna/geodesy.h>
#include <vdna/version.h>

namespace vdna::selectord
{

namespace
{

constexpr uint32_t reasons_most = 5; // as ranking_t says

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

// The generated structs have no const members, although publishing changes nothing.
char *borrow(const char *text)
{
    return const_cast<char *>(text);
}

} // namespace

ProcessId identify_process()
{
    std::random_device random;
    const uint64_t drawn = uint64_t{random()} << 32 | random();
    ProcessId process{static_cast<int64_t>(drawn), "", ""};
    std::array<char, HOST_NAME_MAX + 1> host{};
    if (gethostname(host.data(), host.size()) == 0)
        process.host = host.data();
    std::ifstream("/proc/sys/kernel/random/boot_id") >> process.boot;
    return process;
}

RankingReport::RankingReport(const Map &map, const vdna_backbone_info &backbone,
                             const std::string &map_hash, const Trust &trust,
                             uint32_t warmup_frames)
    : trust_(trust), warmup_frames_(static_cast<int>(warmup_frames)),
      experiences_(map.experiences()), names_(experiences_.size()), distances_(experiences_.size()),
      tied_(experiences_.size()), bound_(experiences_.size()), recalls_(experiences_.size()),
      lows_(experiences_.size()), highs_(experiences_.size()), transfers_(experiences_.size()),
      explainer_(experiences_.front().identity, reasons_most)
{
    message_.validity = VDNA_MSG_RANKING_T_VALID;
    message_.backbone = borrow(backbone.identity.backbone);
    message_.comparable = borrow(experiences_.front().comparable);
    message_.map_hash = borrow(map_hash.c_str());
    message_.ranked_by = borrow("emd");
    message_.verdict = message_.previous = borrow("");
    message_.no_prediction = borrow("");
    message_.unlike = not_known;
    message_.skill = trust.skill();
    message_.count = static_cast<int32_t>(experiences_.size());
    message_.experience = names_.data();
    message_.distance_bins = distances_.data();
    message_.tied = tied_.data();
    message_.bound = bound_.data();
    message_.predicted_recall = recalls_.data();
    message_.predicted_low = lows_.data();
    message_.predicted_high = highs_.data();
    message_.transfer = transfers_.data();
    for (size_t i = 0; i < names_.size(); i++)
        names_[i] = borrow(experiences_[i].name);
    lay_out_reasons();
}

// Room for as many as there may be, with the longest texts, so that the size is known.
void RankingReport::lay_out_reasons()
{
    const size_t count = experiences_.size() > 1 ? explainer_.reasons().size() : 0;
    const auto longest =
        std::max_element(explainer_.taps().begin(), explainer_.taps().end(),
                         [](const Tap &a, const Tap &b) { return a.name.size() < b.name.size(); });
    reason_taps_.assign(count, borrow(longest->name.c_str()));
    for (std::vector<int32_t> *numbers :
         {&reason_neurons_, &winner_most_, &winner_least_, &runner_up_most_, &runner_up_least_})
        numbers->resize(count);
    for (std::vector<double> *numbers :
         {&reason_bins_, &live_bins_, &winner_bins_, &runner_up_bins_})
        numbers->resize(count);
    message_.neurons = static_cast<int32_t>(experiences_.front().identity.neurons);
    message_.reasons = static_cast<int32_t>(count);
    message_.reason_tap = reason_taps_.data();
    message_.reason_neuron = reason_neurons_.data();
    message_.reason_bins = reason_bins_.data();
    message_.live_bin = live_bins_.data();
    message_.winner_bin = winner_bins_.data();
    message_.runner_up_bin = runner_up_bins_.data();
    message_.winner_most = winner_most_.data();
    message_.winner_least = winner_least_.data();
    message_.runner_up_most = runner_up_most_.data();
    message_.runner_up_least = runner_up_least_.data();
}

uint32_t RankingReport::encoded_size() const
{
    constexpr uint32_t texts_max = 1024; // of verdict, no_prediction and previous
    return static_cast<uint32_t>(vdna_msg_ranking_t_encoded_size(&message_)) + texts_max;
}

size_t RankingReport::memory_size() const
{
    return names_.size() * (sizeof(char *) + 5 * sizeof(double) + 2 * sizeof(int8_t)) +
           explainer_.memory_size() +
           reason_taps_.size() * (sizeof(char *) + 5 * sizeof(int32_t) + 4 * sizeof(double));
}

const vdna_trust_prediction *RankingReport::prediction(const vdna_select &select,
                                                       uint32_t candidate) const
{
    const vdna_trust_prediction *const all = vdna_select_predictions(&select, nullptr);
    return all && !is_switch_ ? &all[candidate] : nullptr;
}

int32_t RankingReport::settled_frames(const vdna_select &select) const
{
    return vdna_select_is_early(&select) ? message_.window_frames : 0;
}

// The choice as a whole.
void RankingReport::fill_trust(const vdna_select &select)
{
    const vdna_trust_answer &trust = *vdna_select_trust(&select);
    const uint32_t chosen = vdna_select_chosen(&select);
    const vdna_trust_prediction *const expected = prediction(select, chosen);
    const bool fits = vdna_select_state(&select) != VDNA_SELECT_NONE_FITS;
    message_.validity = fits ? VDNA_MSG_RANKING_T_VALID : VDNA_MSG_RANKING_T_NONE_FITS;
    message_.verdict = borrow(fits ? "" : name_of_verdict(trust.verdict));
    message_.unlike = trust.unlike;
    message_.ranked_by = borrow(name_of_order(vdna_select_ranked_by(&select)));
    message_.settled_frames = settled_frames(select);
    message_.previous = borrow(is_switch_ ? experiences_[vdna_select_previous(&select)].name : "");
    message_.no_prediction =
        borrow(expected ? trust_.text_of(expected->reason)
                        : "it was of the warmup, and another experience has been chosen since");
}

void RankingReport::fill_entry(const vdna_select &select, size_t at, const vdna_rank_entry &entry)
{
    names_[at] = borrow(experiences_[entry.candidate].name);
    distances_[at] = entry.distance_bins;
    tied_[at] = static_cast<int8_t>(entry.tied);
    bound_[at] = static_cast<int8_t>(vdna_select_is_bound(&select, entry.candidate));
    const vdna_trust_prediction *const expected = prediction(select, entry.candidate);
    recalls_[at] = expected ? expected->recall : not_known;
    lows_[at] = expected ? expected->low : not_known;
    highs_[at] = expected ? expected->high : not_known;
    transfers_[at] = expected ? expected->transfer : not_known;
}

void RankingReport::fill_reason(size_t at, const Reason &reason)
{
    reason_taps_[at] = borrow(explainer_.taps()[reason.tap].name.c_str());
    reason_neurons_[at] = static_cast<int32_t>(reason.index);
    reason_bins_[at] = reason.part.margin_bins;
    live_bins_[at] = reason.live_bin;
    winner_bins_[at] = reason.winner_bin;
    runner_up_bins_[at] = reason.against_bin;
    winner_most_[at] = reason.of_winner.most;
    winner_least_[at] = reason.of_winner.least;
    runner_up_most_[at] = reason.of_against.most;
    runner_up_least_[at] = reason.of_against.least;
}

// Files that are cut short under us read as zeros, which do not compare: then there are no reasons.
void RankingReport::explain(const vdna_select &select)
{
    message_.reasons = 0;
    if (experiences_.size() < 2)
        return;
    const vdna_rank_entry *const ranking = vdna_select_ranking(&select, nullptr);
    vdna_hist_view live{};
    vdna_select_live(&select, &live);
    if (explainer_.explain(live, experiences_[ranking[0].candidate],
                           experiences_[ranking[1].candidate]) != VDNA_OK)
        return;
    for (size_t i = 0; i < reason_taps_.size(); i++)
        fill_reason(i, explainer_.reasons()[i]);
    message_.reasons = static_cast<int32_t>(reason_taps_.size());
}

const vdna_msg_ranking_t &RankingReport::fill(const vdna_select &select, bool is_switch)
{
    is_switch_ = is_switch;
    message_.utime = vdna_select_last_utime(&select);
    message_.window_begin_utime = vdna_select_first_utime(&select);
    message_.window_frames = static_cast<int32_t>(vdna_select_window_frames(&select));
    return fill_again(select);
}

const vdna_msg_ranking_t &RankingReport::fill_again(const vdna_select &select)
{
    message_.repeated = 0;
    message_.margin_bins = vdna_select_margin_bins(&select);
    const vdna_rank_entry *const ranking = vdna_select_ranking(&select, nullptr);
    for (size_t i = 0; i < experiences_.size(); i++)
        fill_entry(select, i, ranking[i]);
    fill_trust(select);
    fill_sentence(select);
    return message_;
}

const vdna_msg_ranking_t &RankingReport::repeat()
{
    message_.repeated = 1;
    return message_;
}

// Of the first, or of what is pinned or kept by shadow instead.
void RankingReport::fill_sentence(const vdna_select &select)
{
    const char *const choice = experiences_[vdna_select_chosen(&select)].name;
    if (choice == names_[0]) {
        sentence_ = program::sentence_of({names_[0], message_.previous, message_.count,
                                          message_.window_frames, warmup_frames_, message_.verdict,
                                          message_.unlike, recalls_[0], lows_[0], highs_[0],
                                          message_.no_prediction, message_.skill});
        return;
    }
    const bool is_pinned = vdna_select_pinned(&select) != VDNA_SELECT_NONE;
    const char *const misfit = message_.verdict[0] == '\0' ? ""
                               : std::strcmp(message_.verdict, "poor") == 0
                                   ? ", with poor recall"
                                   : ", which this run is unlike";
    std::snprintf(sentence_.data(), sentence_.size(), "%s is %s%s; recommended is %s", choice,
                  is_pinned ? "pinned" : "kept by shadow", misfit, names_[0]);
}

namespace
{

// Of a message with these three fields.
template <typename Message>
void fill_expected(const vdna_trust_prediction *prediction, Message &message)
{
    message.predicted_recall = prediction ? prediction->recall : not_known;
    message.predicted_low = prediction ? prediction->low : not_known;
    message.predicted_high = prediction ? prediction->high : not_known;
}

} // namespace

void expect(const vdna_trust_prediction *prediction, vdna_msg_localisation_t &message)
{
    fill_expected(prediction, message);
}

vdna_msg_localisation_t no_position(int64_t utime, int32_t validity, const char *reason)
{
    vdna_msg_localisation_t message{};
    message.utime = utime;
    message.validity = validity;
    message.reason = borrow(reason);
    message.experience = borrow("");
    message.position_frame = borrow("");
    message.frame = message.nearest_frame = -1;
    message.confidence = message.distance = not_known;
    fill_expected(nullptr, message);
    return message;
}

namespace
{

// Positions go out as they came: Earth-centred ones as degrees and height, local ones as metres.
void fill_position(const vdna_experience &map, const double *position,
                   vdna_msg_localisation_t &message)
{
    double *const out = message.position;
    message.has_position = 1;
    message.position_frame = borrow(map.position_frame);
    if (std::strcmp(map.position_frame, VDNA_FRAME_WGS84) == 0)
        vdna_geodesy_from_ecef(position, &out[0], &out[1], &out[2]);
    else
        std::copy(position, position + 3, out);
}

} // namespace

namespace
{

// Where a frame of the map was taken.
void fill_place(const vdna_experience &map, uint32_t frame, vdna_msg_localisation_t &message)
{
    message.experience = borrow(map.name);
    message.frame = static_cast<int32_t>(frame);
    message.frame_utime = map.frame_utime[frame];
    if (map.frame_place && map.frame_place[frame] != VDNA_PLACE_NONE) {
        message.has_place = 1;
        message.place = map.frame_place[frame];
    }
    const double *const position =
        map.frame_position ? map.frame_position + size_t{3} * frame : nullptr;
    if (position && !std::isnan(position[0]))
        fill_position(map, position, message);
}

} // namespace

vdna_msg_localisation_t nearest_in(const vdna_experience &map, const vdna_knn_match &match,
                                   int64_t utime)
{
    vdna_msg_localisation_t message = no_position(utime, VDNA_MSG_LOCALISATION_T_VALID);
    fill_place(map, match.index, message);
    message.moving = 1;
    message.nearest_frame = message.frame;
    message.distance = std::sqrt(match.distance_sq);
    return message;
}

vdna_msg_localisation_t position_in(const vdna_experience &map, const vdna_localise_answer &answer,
                                    double min_confidence, int64_t utime)
{
    const bool is_sure = answer.confidence >= min_confidence;
    vdna_msg_localisation_t message = no_position(utime, is_sure ? VDNA_MSG_LOCALISATION_T_VALID
                                                                 : VDNA_MSG_LOCALISATION_T_UNSURE);
    fill_place(map, answer.frame, message);
    message.confidence = answer.confidence;
    message.moving = static_cast<int8_t>(answer.moving);
    message.nearest_frame = static_cast<int32_t>(answer.nearest);
    message.distance = answer.nearest_distance;
    return message;
}

namespace
{

vdna_msg_duration_t duration_of(const Durations &durations)
{
    vdna_msg_duration_t duration{};
    duration.newest_us = durations.newest_us();
    duration.p50_us = durations.percentile_us(50);
    duration.p99_us = durations.percentile_us(99);
    duration.max_us = durations.max_us();
    return duration;
}

void fill_counters(const StatusFacts &facts, vdna_msg_status_t &message)
{
    const vdna_transport_counters &counters = facts.transport;
    message.received = static_cast<int64_t>(counters.received);
    message.processed = static_cast<int64_t>(facts.counts.accepted);
    message.parked = static_cast<int64_t>(facts.parked);
    message.carried = static_cast<int64_t>(facts.carried);
    message.over_rate = static_cast<int64_t>(facts.over_rate);
    message.refused = static_cast<int64_t>(facts.refused);
    message.unusable = static_cast<int64_t>(facts.unusable);
    message.skipped = static_cast<int64_t>(counters.skipped + facts.stood_by);
    message.oversized = static_cast<int64_t>(counters.oversized);
    message.late = static_cast<int64_t>(facts.counts.late);
    message.rejected = static_cast<int64_t>(counters.rejected);
    message.lost = static_cast<int64_t>(counters.lost);
    message.incomplete = static_cast<int64_t>(counters.incomplete);
    message.dropped_datagrams = static_cast<int64_t>(counters.dropped_datagrams);
    message.malformed_datagrams = static_cast<int64_t>(counters.malformed_datagrams);
    message.repeated_datagrams = static_cast<int64_t>(counters.repeated_datagrams);
    message.foreign_datagrams = static_cast<int64_t>(counters.foreign_datagrams);
    message.unprotected_frames = static_cast<int64_t>(counters.unprotected_frames);
    message.corrupted_frames = static_cast<int64_t>(counters.corrupted_frames);
    message.repeated_frames = static_cast<int64_t>(counters.repeated_frames);
    message.reordered_frames = static_cast<int64_t>(counters.reordered_frames);
    message.lost_frames = static_cast<int64_t>(counters.lost_frames);
    message.restarts = static_cast<int64_t>(facts.counts.restarts);
    message.switches = static_cast<int64_t>(facts.counts.switches);
}

void fill_stages(const Stages &stages, vdna_msg_status_t &message)
{
    message.queue_time = duration_of(stages.queue);
    message.decode_time = duration_of(stages.decode);
    message.resize_time = duration_of(stages.resize);
    message.inference_time = duration_of(stages.inference);
    message.select_time = duration_of(stages.select);
    message.rank_time = duration_of(stages.rank);
    message.publish_time = duration_of(stages.publish);
    message.total_time = duration_of(stages.total);
}

void fill_memory(const StatusFacts &facts, vdna_msg_status_t &message)
{
    message.resident_bytes = facts.resident.now;
    message.resident_bytes_max = facts.resident.most;
    message.picture_bytes_max = static_cast<int64_t>(facts.transport.picture_bytes_max);
    message.window_frames_max = static_cast<int32_t>(facts.window_frames_max);
    message.backlog_max = static_cast<int32_t>(facts.transport.backlog_max);
}

} // namespace

vdna_msg_status_t status_of(const StatusFacts &facts, int64_t utime)
{
    const bool selected = vdna_select_has_choice(&facts.select) != 0;
    const uint32_t pinned = vdna_select_pinned(&facts.select);
    const uint32_t chosen = vdna_select_chosen(&facts.select);
    vdna_msg_status_t message{};
    message.utime = utime;
    message.state = facts.state.state;
    message.instance = facts.process.instance;
    message.serving_utime = facts.serving_utime;
    message.host = borrow(facts.process.host.c_str());
    message.boot_id = borrow(facts.process.boot.c_str());
    message.reason = borrow(facts.state.reason);
    message.frame_age_us = facts.state.frame_age_us;
    message.progress = vdna_select_progress(&facts.select);
    message.experience = borrow(selected ? facts.experiences[chosen].name : "");
    fill_expected(facts.ranking.prediction(facts.select, chosen), message);
    message.skill = facts.ranking.skill();
    message.settled_frames = facts.ranking.settled_frames(facts.select);
    message.experiences = static_cast<int32_t>(facts.experiences.size());
    message.left_out = static_cast<int32_t>(facts.left_out);
    message.map_hash = borrow(facts.map_hash.c_str());
    message.map_changed = facts.map_changed;
    message.pinned = borrow(pinned == VDNA_SELECT_NONE ? "" : facts.experiences[pinned].name);
    message.shadow = static_cast<int8_t>(vdna_select_in_shadow(&facts.select));
    message.excluded_count = static_cast<int32_t>(facts.excluded.size());
    message.excluded = facts.excluded.data();
    message.backbone = borrow(facts.backbone.identity.backbone);
    message.version = borrow(vdna_version());
    fill_counters(facts, message);
    fill_stages(facts.stages, message);
    fill_memory(facts, message);
    message.message = borrow(facts.message);
    return message;
}

} // namespace vdna::selectord
