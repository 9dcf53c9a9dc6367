#include "selectord/daemon.hpp"

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <utility>

#include <vdna_messages.h>
#include <vdna_msg_command_result_t.h>
#include <vdna_msg_command_t.h>

#include <vdna/cpp/error.hpp>

#include "program/clock.hpp"
#include "telemetry/commands.hpp"
#include "telemetry/message_text.hpp"

namespace vdna::selectord
{

namespace
{

constexpr int64_t status_period_us = 1000000;
constexpr int32_t poll_ms = 50; // bounds the delay of a stop or a status without frames

// A ranking of a map that a reload brings may be larger than that of the map at the start.
constexpr uint32_t ranking_growth = 2;
constexpr uint32_t message_size_min = 1 << 14;

// Why a picture is left out.
const char *sentence_of(uint32_t verdict)
{
    switch (verdict) {
    case VDNA_HEALTH_TOO_SMALL:
        return "the picture is too small to show anything";
    case VDNA_HEALTH_SATURATED:
        return "the picture is white: overexposed, or blinded by a light";
    case VDNA_HEALTH_UNIFORM:
        return "the picture shows one grey level: black, grey, or a covered lens";
    case VDNA_HEALTH_NOISE:
        return "the picture is noise";
    case VDNA_HEALTH_SIZE_CHANGED:
        return "the size of the pictures has just changed";
    case VDNA_HEALTH_FROZEN:
        return "the picture is the one before it, pixel by pixel: the camera is frozen";
    default:
        return "the picture came before, pixel by pixel: the camera repeats itself";
    }
}

// Looks in a row that show something new before the robot drives, and how seldom it is looked then.
constexpr uint32_t misses_of_a_stand = 3, driving_frames_a_look = 4;

constexpr const char *is_lost = "the places jump as on another route";

// Whether the frame went into the selection.
bool is_used(const vdna_msg_localisation_t &answer)
{
    return answer.validity != VDNA_MSG_LOCALISATION_T_REFUSED &&
           answer.validity != VDNA_MSG_LOCALISATION_T_FAULT;
}

} // namespace

Daemon::Daemon(const Config &config, OpenedMap map, const Backbone &backbone,
               BackboneProcess *process)
    : config_(config), backbone_(backbone), process_(process),
      is_replay_(vdna_transport_is_log(config.url.c_str()) != 0), process_id_(identify_process()),
      session_(std::make_unique<MapSession>(config, std::move(map), backbone.info())),
      message_size_max_(
          std::max({ranking_growth * session_->ranking().encoded_size(), message_size_min}) +
          other_messages_size_max),
      waiting_(config, is_replay_), rate_limit_(config.max_rate_hz), stride_(config.every_m),
      standby_(process_id_.instance, program::wall_us())
{
    vdna_health_init(&health_, nullptr); // cannot fail: the defaults are valid
    vdna_parked_init(&parked_, static_cast<uint32_t>(std::lround(100 * config.parked)));
    if (config.parked > 0 && !process_)
        glance_.emplace(config.max_image_pixels);
    keep_to_settings();
}

// Of the operator, before the first frame.
void Daemon::keep_to_settings()
{
    vdna_select_shadow(session_->select(), config_.shadow ? 1 : 0);
    if (config_.pin.empty())
        return;
    if (const Outcome outcome = pin(*session_, config_.pin); !outcome.accepted)
        problems_.note(program::monotonic_us(), "select.pin: %s", outcome.text.c_str());
}

size_t Daemon::size() const
{
    return sizeof *this + session_->size();
}

void Daemon::reload_when(std::atomic<bool> &requested, uint64_t held_bytes)
{
    reload_.emplace(config_, backbone_.info(), requested,
                    MapReload::Room{message_size_max_, held_bytes});
}

void Daemon::keep_answers(const std::string &path)
{
    answers_.emplace(path);
}

void Daemon::run(vdna_transport *transport, const std::atomic<bool> &stop,
                 const ServiceManager &manager)
{
    if (is_replay_ && !answers_)
        std::fprintf(stderr,
                     "vdna_selectord: answers to a log cannot be sent and are not kept; keep "
                     "them with --answers FILE\n");
    overhear(transport); // of a log, the first poll may take hundreds of messages
    manager.ready();
    int64_t next_status_us = program::monotonic_us();
    while (!stop) {
        uint32_t events = 0;
        vdna_transport_frame frame;
        if (vdna_transport_poll(transport, poll_ms, &events, &frame) != VDNA_OK) {
            if (is_replay_)
                return end_log(transport);
            throw Error("the LCM connection is gone; see to the network and start again");
        }

        judge_peers(transport);
        if (events & VDNA_TRANSPORT_COMMAND)
            take_commands(transport);
        if (reload_)
            go_on_reloading(transport, manager);
        if (events & VDNA_TRANSPORT_FRAME)
            answer(transport, frame, stop);

        // At 1 Hz, with or without frames; beats missed during a long inference are dropped.
        const int64_t now_us = program::monotonic_us();
        if (now_us >= next_status_us || standby_.has_newcomer()) {
            beat(transport, manager);
            if (now_us >= next_status_us)
                next_status_us +=
                    ((now_us - next_status_us) / status_period_us + 1) * status_period_us;
        }
    }
    manager.stopping();
}

// Once a second: say what is wrong, listen around if that helps, publish the status and repeat the
// choice.
void Daemon::beat(vdna_transport *transport, const ServiceManager &manager)
{
    verdict_ = waiting_.judge(facts(transport));
    if (verdict_.is_news)
        std::fprintf(stderr, "vdna_selectord: %s\n", verdict_.text.data());
    overhear(transport);
    map_is_changed_ = session_->is_directory_changed();
    publish_status(transport);
    repeat_choice(transport);
    if (network_makes_progress()) // as do the loop, and the transport that it has polled
        manager.alive();
}

// Whether another daemon answers on our channels. What was seen before we stood by is old then.
void Daemon::judge_peers(vdna_transport *transport)
{
    uint32_t count = 0;
    const vdna_transport_peer *peers = vdna_transport_peers(transport, &count);
    if (!standby_.judge(peers, count, program::monotonic_us(), program::wall_us()))
        return;
    forget();
    problems_.note(program::monotonic_us(), "%s",
                   standby_.stands_by() ? standby_.reason()
                                        : "no other daemon answers on these channels: serving");
}

// It has answered since the last beat, or nothing was asked.
bool Daemon::network_makes_progress()
{
    const bool answers = std::exchange(network_answers_, 0) > 0;
    return std::exchange(network_runs_, 0) == 0 || answers;
}

void Daemon::overhear(vdna_transport *transport)
{
    if (vdna_transport_overhear(transport, waiting_.wants_to_overhear()) != VDNA_OK)
        problems_.note(program::monotonic_us(), "LCM cannot listen to the other channels");
}

Facts Daemon::facts(vdna_transport *transport) const
{
    const FrameCounts counts = session_->counts();
    Facts facts;
    facts.now_us = program::monotonic_us();
    facts.camera = *vdna_transport_count(transport);
    facts.overheard = vdna_transport_overheard_channels(transport, &facts.overheard_count);
    facts.selected = vdna_select_has_choice(session_->select()) != 0;
    facts.progress = vdna_select_progress(session_->select());
    facts.accepted = counts.accepted + parked_frames_ + carried_;
    facts.parked = parked_frames_;
    facts.refused = refused_;
    facts.late = counts.late;
    facts.still = vdna_select_time(session_->select())->still;
    facts.restarts = counts.restarts;
    facts.refusal = refusal_.data();
    facts.restart_reason = vdna_restart_text(vdna_select_restart_cause(session_->select()));
    return facts;
}

void Daemon::end_log(vdna_transport *transport) const
{
    const Facts end = facts(transport);
    const Verdict verdict = end.selected ? Verdict{} : waiting_.judge_end(end);
    if (end.accepted == 0)
        throw Error("the log has ended and no frame of it could be used: " +
                    std::string(verdict.text.data()));
    std::fprintf(stderr,
                 "vdna_selectord: the log has ended: %" PRIu64 " frames answered, %" PRIu64
                 " of them with a position; %" PRIu64 " refused, %" PRIu64 " oversized, %" PRIu64
                 " messages rejected\n",
                 end.accepted + end.refused, localised_, end.refused, end.camera.oversized,
                 end.camera.rejected);
    if (!end.selected)
        std::fprintf(stderr,
                     "vdna_selectord: no experience was chosen, the warmup is at %.0f %%%s%s\n",
                     100 * end.progress, verdict.text[0] ? ": " : "", verdict.text.data());
    if (end.camera.damaged_bytes > 0)
        throw Error(std::to_string(end.camera.damaged_bytes) +
                    " bytes of the log are damaged and were passed over; the answers leave out the "
                    "frames in them");
}

// What was seen may come again.
void Daemon::forget()
{
    vdna_select_reset(session_->select());
    vdna_health_init(&health_, nullptr);
    degraded_[0] = '\0';
    newest_.reset();
}

// One that stands by does the same, so that it would take over with the same choice, and is silent.
void Daemon::take_commands(vdna_transport *transport)
{
    uint32_t count = 0;
    const vdna_transport_command *const commands = vdna_transport_commands(transport, &count);
    for (uint32_t i = 0; i < count; i++) {
        const Outcome outcome = take(transport, commands[i]);
        commands_.note(program::monotonic_us(), "%s: %s",
                       telemetry::name_of_command(commands[i].command),
                       (outcome.accepted ? outcome.text : "refused, " + outcome.text).c_str());
        const bool is_under_way =
            outcome.accepted && commands[i].command == VDNA_MSG_COMMAND_T_RELOAD;
        if (!is_under_way)
            answer_command(transport, commands[i].utime, commands[i].command, outcome);
    }
}

Outcome Daemon::take(vdna_transport *transport, const vdna_transport_command &command)
{
    if (command.command == VDNA_MSG_COMMAND_T_RESET)
        return reset();
    if (command.command != VDNA_MSG_COMMAND_T_RELOAD)
        return change_choice(transport, command);
    if (!reload_)
        return {false, "the answers to a log are those of one map"};
    if (!reload_->request(command.utime))
        return {false, "another reload waits to begin, and will open the same map"};
    return {true, "opening the map's directory"};
}

Outcome Daemon::reset()
{
    forget();
    return {true, "warming up"};
}

// PIN, EXCLUDE, INCLUDE, SHADOW. A change of the choice or the recommendation is announced at once.
Outcome Daemon::change_choice(vdna_transport *transport, const vdna_transport_command &command)
{
    const vdna_select *const select = session_->select();
    const auto first = [select] {
        const vdna_rank_entry *const ranking = vdna_select_ranking(select, nullptr);
        return ranking ? ranking->candidate : VDNA_SELECT_NONE;
    };
    const uint32_t recommended = first(), chosen = vdna_select_chosen(select);
    newest_.reset();
    Outcome outcome = carry_out(*session_, command);
    const bool is_changed = recommended != first() || chosen != vdna_select_chosen(select);
    if (first() != VDNA_SELECT_NONE && is_changed) {
        session_->ranking().explain(*select);
        announce_choice(transport, session_->ranking().fill_again(*select));
    }
    return outcome;
}

void Daemon::answer_command(vdna_transport *transport, int64_t utime, int32_t command,
                            const Outcome &outcome)
{
    if (standby_.stands_by())
        return;
    vdna_msg_command_result_t result{};
    result.utime = utime;
    result.command = command;
    result.accepted = static_cast<int8_t>(outcome.accepted);
    result.text = const_cast<char *>(outcome.text.c_str()); // publishing changes nothing
    result.map_hash = const_cast<char *>(session_->map_hash().c_str());
    publish(transport, config_.command_result_channel, vdna_message_command_result, &result);
}

// Between two frames, so each is answered from one map as a whole.
void Daemon::go_on_reloading(vdna_transport *transport, const ServiceManager &manager)
{
    if (reload_->begin(*session_))
        manager.reloading();
    Outcome outcome{};
    try {
        std::unique_ptr<MapSession> next = reload_->take();
        if (!next)
            return;
        outcome = end_reload(std::move(next));
    } catch (const std::exception &error) {
        map_is_old_ = true;
        outcome = {false, std::string("not reloaded, the old map serves: ") + error.what()};
        reload_problems_.note(program::monotonic_us(), "%s", outcome.text.c_str());
    }
    answer_command(transport, reload_->utime(), VDNA_MSG_COMMAND_T_RELOAD, outcome);
    manager.ready();
}

Outcome Daemon::end_reload(std::unique_ptr<MapSession> next)
{
    newest_.reset();
    next->count_on_from(*session_);
    const std::string lost = carry_over(*session_, *next);
    session_ = std::move(next);
    map_is_old_ = false;
    session_->say_no_trust();
    const std::string text =
        "the map is reloaded: " + std::to_string(session_->experiences().size()) +
        " experiences, warming up" + lost;
    reloads_.note(program::monotonic_us(), "%s", text.c_str());
    return {true, text};
}

void Daemon::answer(vdna_transport *transport, const vdna_transport_frame &frame,
                    const std::atomic<bool> &stop)
{
    unanswered_ += frame.skipped;
    if (standby_.stands_by()) {
        stood_by_++;
        unanswered_++;
        return;
    }
    if (!rate_limit_.takes(time_of(frame))) {
        over_rate_++;
        unanswered_++;
        return;
    }
    if (session_->fault()[0] != '\0')
        return send(transport, frame,
                    refuse(frame, session_->fault(), VDNA_MSG_LOCALISATION_T_FAULT));
    if (newest_ && frame.utime > newest_stamp_ && stride_.is_near(time_of(frame)))
        return repeat(transport, frame, VDNA_MSG_LOCALISATION_T_CARRIED);
    bool looked = false;
    if (is_parked(frame, looked))
        return repeat(transport, frame, VDNA_MSG_LOCALISATION_T_PARKED);

    const int64_t begin_us = program::monotonic_us();
    vdna_backbone_frame seen;
    vdna_error error{};
    const vdna_status status = vdna_backbone_run(backbone_.get(), &frame.image, &error, &seen);
    if (stop)
        return; // cancelled: the frame is not at fault
    network_runs_++;
    network_answers_ += has_replied(status);
    network_failed_ = is_at_fault(status);

    newest_.reset();
    Stopwatch watch;
    std::optional<vdna_msg_localisation_t> answer =
        status == VDNA_OK ? use(transport, frame, seen, watch) : refuse(frame, error.text);
    if (!answer) {
        unanswered_++;
        return;
    }
    if (!is_used(*answer))
        return send(transport, frame, *answer);
    note_used(*answer);
    mark_degraded(*answer);
    remember(*answer, frame, looked);
    send(transport, frame, *answer);

    stages_.queue.add(begin_us - frame.received_us);
    stages_.decode.add(seen.decode_us);
    stages_.resize.add(seen.resize_us);
    stages_.inference.add(seen.inference_us);
    stages_.publish.add(watch.lap_us());
    stages_.total.add(program::monotonic_us() - frame.received_us);
    vdna_select_catch_up(session_->select()); // while the next frame is on its way
}

// Of a log, which is read at any speed, its camera's.
int64_t Daemon::time_of(const vdna_transport_frame &frame) const
{
    return is_replay_ ? frame.utime : frame.received_us;
}

// A warmup counts what it is shown, unless it is to have distinct pictures only. Frames that do not
// move camera time forward go the whole way, where they are judged.
bool Daemon::may_be_parked() const
{
    const bool warms_up = vdna_select_state(session_->select()) == VDNA_SELECT_WARMUP;
    return config_.parked > 0 && newest_ && degraded_[0] == '\0' &&
           (!warms_up || config_.warmup_distinct);
}

// A look costs something, and while the robot drives it tells nothing.
bool Daemon::is_look_due()
{
    return misses_ < misses_of_a_stand || ++unlooked_ >= driving_frames_a_look;
}

bool Daemon::is_parked(const vdna_transport_frame &frame, bool &out_looked)
{
    if (!may_be_parked() || frame.utime <= newest_stamp_ || !is_look_due())
        return false;
    vdna_parked_picture picture;
    out_looked = glance_ ? glance_->look(frame.image, picture)
                         : process_ && process_->look(frame.image, picture);
    if (!out_looked)
        return false;
    unlooked_ = 0;
    const bool is_like = vdna_parked_look(&parked_, &picture) != 0;
    misses_ = is_like ? 0 : misses_ + 1;
    return is_like && has_newest_look_;
}

void Daemon::repeat(vdna_transport *transport, const vdna_transport_frame &frame, int32_t basis)
{
    const bool is_parked = basis == VDNA_MSG_LOCALISATION_T_PARKED;
    (is_parked ? parked_frames_ : carried_)++;
    newest_stamp_ = frame.utime;
    localised_ += newest_->frame >= 0;
    vdna_msg_localisation_t answer = *newest_;
    answer.utime = frame.utime;
    answer.basis = basis;
    if (is_parked)
        answer.moving = 0;
    note_used(answer);
    send(transport, frame, answer);
}

void Daemon::remember(const vdna_msg_localisation_t &answer, const vdna_transport_frame &frame,
                      bool looked)
{
    newest_ = answer;
    newest_stamp_ = frame.utime;
    has_newest_look_ = looked;
    if (looked)
        vdna_parked_keep(&parked_);
    const vdna_select_position *const where = vdna_select_where(session_->select());
    if (where && degraded_[0] == '\0')
        stride_.note(session_->experiences()[where->candidate], where->candidate,
                     where->answer.frame, time_of(frame));
    else
        stride_.forget();
}

// A log waits for us, and is to give the same answers again.
void Daemon::send(vdna_transport *transport, const vdna_transport_frame &frame,
                  vdna_msg_localisation_t answer)
{
    answer.skipped = static_cast<int64_t>(std::exchange(unanswered_, 0));
    answer.latency_us = is_replay_ ? 0 : program::monotonic_us() - frame.received_us;
    publish(transport, config_.localisation_channel, vdna_message_localisation, &answer);
}

std::optional<vdna_msg_localisation_t> Daemon::use(vdna_transport *transport,
                                                   const vdna_transport_frame &frame,
                                                   const vdna_backbone_frame &seen,
                                                   Stopwatch &watch)
{
    if (const char *fault = fault_of(seen); fault[0] != '\0') {
        unusable_++;
        return refuse(frame, fault);
    }
    const vdna_select_frame live{frame.utime, seen.taps, seen.tap_count,
                                 session_->embedding_of(seen)};
    const uint64_t switches = vdna_select_switches(session_->select());
    vdna_select_answer found;
    const vdna_status status =
        vdna_select_feed_seen(session_->select(), &live, session_->last_layer_of(seen), &found);
    if (status == VDNA_ERR_LATE)
        return {};
    const bool is_switch = vdna_select_switches(session_->select()) != switches;
    const bool is_choice = status == VDNA_OK && (found.newly_ranked || is_switch);
    if (is_choice)
        session_->ranking().explain(*session_->select());
    if (const char *fault = session_->fault(); fault[0] != '\0')
        return status == VDNA_OK ? no_position(frame.utime, VDNA_MSG_LOCALISATION_T_FAULT, fault)
                                 : refuse(frame, fault, VDNA_MSG_LOCALISATION_T_FAULT);
    if (status != VDNA_OK)
        return refuse(frame, vdna_status_text(status));
    (is_choice ? stages_.rank : stages_.select).add(watch.lap_us());
    window_frames_max_ =
        std::max(window_frames_max_, vdna_select_window_frames(session_->select()));

    if (found.restarted)
        problems_.note(program::monotonic_us(), "the warmup began anew, %s",
                       vdna_restart_text(found.restarted));
    if (is_choice)
        announce_choice(transport, session_->ranking().fill(*session_->select(), is_switch));
    if (!found.localised)
        return no_position(frame.utime, VDNA_MSG_LOCALISATION_T_WARMING_UP);
    localised_++;
    return trusted_place_of(found.match, frame.utime);
}

const char *Daemon::fault_of(const vdna_backbone_frame &seen)
{
    if (!config_.frame_health || seen.health.width == 0)
        return "";
    const uint32_t verdict = vdna_health_take(&health_, &seen.health);
    const uint32_t degraded = vdna_health_degraded(&health_);
    degraded_[0] = '\0';
    if (degraded != VDNA_HEALTH_OK)
        std::snprintf(degraded_.data(), degraded_.size(),
                      "more than half of the camera's last pictures are unusable: %s",
                      vdna_health_text(degraded));
    return verdict == VDNA_HEALTH_OK ? "" : sentence_of(verdict);
}

void Daemon::note_used(const vdna_msg_localisation_t &answer)
{
    used_us_ = program::monotonic_us();
    validity_ = answer.validity;
}

void Daemon::mark_degraded(vdna_msg_localisation_t &answer) const
{
    if (degraded_[0] == '\0' || answer.validity == VDNA_MSG_LOCALISATION_T_WARMING_UP)
        return;
    answer.validity = VDNA_MSG_LOCALISATION_T_DEGRADED;
    answer.reason = const_cast<char *>(degraded_.data()); // publishing changes nothing
}

// Until a frame has been used there is no age: Waiting says why none comes.
State Daemon::state()
{
    const int64_t age_us = used_us_ == 0 ? -1 : program::monotonic_us() - used_us_;
    const double stale_us = config_.stale_seconds > 0
                                ? 1e6 * config_.stale_seconds
                                : 1e6 + 2.0 * static_cast<double>(stages_.total.percentile_us(50));
    if (standby_.stands_by())
        return {VDNA_MSG_STATUS_T_STANDBY, standby_.reason(), age_us};
    if (session_->fault()[0] != '\0')
        return {VDNA_MSG_STATUS_T_FAULT, session_->fault(), age_us};
    if (network_failed_)
        return {VDNA_MSG_STATUS_T_DEGRADED, refusal_.data(), age_us};
    if (degraded_[0] != '\0')
        return {VDNA_MSG_STATUS_T_DEGRADED, degraded_.data(), age_us};
    if (static_cast<double>(age_us) > stale_us)
        return {VDNA_MSG_STATUS_T_STALE,
                "no frame has been used for longer than camera.stale_seconds", age_us};
    if (!vdna_select_has_choice(session_->select()))
        return {VDNA_MSG_STATUS_T_WARMUP, "", age_us};
    if (vdna_select_state(session_->select()) == VDNA_SELECT_NONE_FITS)
        return {VDNA_MSG_STATUS_T_NONE_FITS, session_->ranking().sentence(), age_us};
    if (vdna_select_is_lost(session_->select()))
        return {VDNA_MSG_STATUS_T_UNSURE, is_lost, age_us};
    const bool is_unsure = validity_ == VDNA_MSG_LOCALISATION_T_UNSURE;
    return {is_unsure ? VDNA_MSG_STATUS_T_UNSURE : VDNA_MSG_STATUS_T_VALID, "", age_us};
}

vdna_msg_localisation_t Daemon::place_of(const vdna_knn_match &match, int64_t utime) const
{
    const std::vector<vdna_experience> &experiences = session_->experiences();
    const vdna_select_position *const where = vdna_select_where(session_->select());
    if (!where)
        return nearest_in(experiences[vdna_select_chosen(session_->select())], match, utime);
    return position_in(experiences[where->candidate], where->answer, config_.min_confidence, utime);
}

vdna_msg_localisation_t Daemon::trusted_place_of(const vdna_knn_match &match, int64_t utime) const
{
    const vdna_select *const select = session_->select();
    vdna_msg_localisation_t place = place_of(match, utime);
    const auto say = [&place](int32_t validity, const char *reason) {
        place.validity = validity;
        place.reason = const_cast<char *>(reason); // publishing changes nothing
    };
    const vdna_select_position *const where = vdna_select_where(select);
    const uint32_t candidate = where ? where->candidate : vdna_select_chosen(select);
    expect(session_->ranking().prediction(*select, candidate), place);
    if (vdna_select_state(select) == VDNA_SELECT_NONE_FITS)
        say(VDNA_MSG_LOCALISATION_T_NONE_FITS, session_->ranking().sentence());
    else if (vdna_select_is_lost(select))
        say(VDNA_MSG_LOCALISATION_T_UNSURE, is_lost);
    return place;
}

vdna_msg_localisation_t Daemon::refuse(const vdna_transport_frame &frame, const char *reason,
                                       int32_t validity)
{
    refused_++;
    std::snprintf(refusal_.data(), refusal_.size(), "%s", reason);
    problems_.note(program::monotonic_us(), "frame of utime %" PRId64 " refused: %s", frame.utime,
                   reason);
    return no_position(frame.utime, validity, refusal_.data());
}

void Daemon::announce_choice(vdna_transport *transport, const vdna_msg_ranking_t &ranking)
{
    publish(transport, config_.ranking_channel, vdna_message_ranking, &ranking);
    choices_.note(program::monotonic_us(), "%s", session_->ranking().sentence());
}

Resident Daemon::resident() const
{
    Resident resident = memory_.read();
    if (process_)
        resident += process_->resident();
    return resident;
}

const char *Daemon::problem() const
{
    if (verdict_.text[0])
        return verdict_.text.data();
    if (map_is_old_)
        return reload_problems_.last();
    return session_->left_out() > 0 ? session_->left_out_text().c_str() : problems_.last();
}

void Daemon::publish_status(vdna_transport *transport)
{
    excluded_.clear();
    list_excluded(*session_, excluded_);
    const StatusFacts now{process_id_,
                          standby_.serving_utime(),
                          state(),
                          *session_->select(),
                          session_->ranking(),
                          *vdna_transport_count(transport),
                          session_->experiences(),
                          session_->left_out(),
                          session_->map_hash(),
                          map_is_changed_,
                          excluded_,
                          backbone_.info(),
                          stages_,
                          session_->counts(),
                          refused_,
                          unusable_,
                          stood_by_,
                          parked_frames_,
                          carried_,
                          over_rate_,
                          window_frames_max_,
                          resident(),
                          problem()};
    const vdna_msg_status_t message = status_of(now, program::wall_us());
    publish(transport, config_.status_channel, vdna_message_status, &message);
}

// For those who listen later. Nothing of it goes into the file of answers, which has the choice.
void Daemon::repeat_choice(vdna_transport *transport)
{
    if (vdna_select_state(session_->select()) == VDNA_SELECT_WARMUP || session_->fault()[0] != '\0')
        return;
    send(transport, config_.ranking_channel, vdna_message_ranking, &session_->ranking().repeat());
}

void Daemon::publish(vdna_transport *transport, const std::string &channel,
                     const vdna_message_type &type, const void *message)
{
    if (answers_)
        keep(channel, type, message);
    send(transport, channel, type, message);
}

void Daemon::send(vdna_transport *transport, const std::string &channel,
                  const vdna_message_type &type, const void *message)
{
    if (is_replay_)
        return;
    const vdna_status sent = vdna_transport_publish(transport, channel.c_str(), &type, message);
    if (sent != VDNA_OK)
        problems_.note(program::monotonic_us(),
                       "%s: a message could not be sent: %s; " VDNA_LCM_REMEDY, channel.c_str(),
                       vdna_status_text(sent));
}

// A status tells of our own time and memory, so a replay, which is to give the same file again,
// leaves it out. Whoever replays wants the file; a robot goes on without it.
void Daemon::keep(const std::string &channel, const vdna_message_type &type, const void *message)
{
    if (is_replay_ && &type == &vdna_message_status)
        return;
    try {
        answers_->write(telemetry::json_line(telemetry::view_of(type), channel, message));
    } catch (const Error &error) {
        if (is_replay_)
            throw;
        problems_.note(program::monotonic_us(), "%s; answers are not kept from here on",
                       error.what());
        answers_.reset();
    }
}

} // namespace vdna::selectord
