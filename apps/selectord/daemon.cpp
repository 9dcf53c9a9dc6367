#include "selectord/daemon.hpp"

#include <algorithm>
#include <chrono>
#include <cinttypes>
#include <cstdio>

#include <vdna_messages.h>

#include <vdna/cpp/error.hpp>

namespace vdna::selectord
{

namespace
{

constexpr int64_t status_period_us = 1000000;
constexpr int32_t poll_ms = 50; // bounds the delay of a stop or a status without frames

int64_t monotonic_us()
{
    using namespace std::chrono;
    return duration_cast<microseconds>(steady_clock::now().time_since_epoch()).count();
}

int64_t wall_us()
{
    using namespace std::chrono;
    return duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

Warmup warmup_of(const Config &config)
{
    return {config.warmup_frames, static_cast<int64_t>(config.warmup_seconds * 1e6)};
}

} // namespace

Daemon::Daemon(const Config &config, const Map &map, const Backbone &backbone)
    : config_(config), map_(map), backbone_(backbone),
      selector_(map.candidates(), map.experiences().front().identity.dim, warmup_of(config),
                config.map_directory),
      ranking_(map, backbone.info())
{
}

uint32_t Daemon::message_size_max() const
{
    return std::max(ranking_.encoded_size(), other_messages_size_max);
}

size_t Daemon::histogram_size() const
{
    vdna_hist_view live;
    vdna_select_live(selector_.get(), &live);
    const size_t numbers_per_neuron = live.bins + 2; // counts, mass, saturated
    return numbers_per_neuron * live.neurons * sizeof(uint32_t);
}

size_t Daemon::size() const
{
    const size_t per_experience = sizeof(char *) + 2 * sizeof(double) + sizeof(int8_t);
    return sizeof *this + selector_.memory_size() + map_.experiences().size() * per_experience;
}

void Daemon::run(vdna_transport *transport, const std::atomic<bool> &stop)
{
    int64_t next_status_us = monotonic_us();
    while (!stop) {
        uint32_t events = 0;
        vdna_transport_frame frame;
        if (vdna_transport_poll(transport, poll_ms, &events, &frame) != VDNA_OK)
            throw Error("the LCM connection is gone; see to the network and start again");

        if (events & VDNA_TRANSPORT_RESET)
            reset();
        if (events & VDNA_TRANSPORT_FRAME)
            answer(transport, frame, stop);

        // At 1 Hz, with or without frames; beats missed during a long inference are dropped.
        const int64_t now_us = monotonic_us();
        if (now_us >= next_status_us) {
            publish_status(transport);
            next_status_us += ((now_us - next_status_us) / status_period_us + 1) * status_period_us;
        }
    }
}

void Daemon::reset()
{
    vdna_select_reset(selector_.get());
    std::fprintf(stderr, "vdna_selectord: reset by command, warming up again\n");
}

void Daemon::answer(vdna_transport *transport, const vdna_transport_frame &frame,
                    const std::atomic<bool> &stop)
{
    const int64_t begin_us = monotonic_us();
    vdna_backbone_frame seen;
    vdna_error error{};
    const vdna_status status = vdna_backbone_run(backbone_.get(), &frame.image, &error, &seen);
    if (stop)
        return; // cancelled: the frame is not at fault

    Stopwatch watch;
    vdna_msg_localisation_t message =
        status == VDNA_OK ? use(transport, frame, seen, watch) : refuse(frame, error.text);
    message.skipped = static_cast<int64_t>(frame.skipped);
    message.latency_us = monotonic_us() - frame.received_us;
    note_unless_sent(vdna_transport_publish(transport, config_.localisation_channel.c_str(),
                                            &vdna_message_localisation, &message),
                     "a localisation");
    if (message.validity == VDNA_MSG_LOCALISATION_T_REFUSED)
        return;

    stages_.queue.add(begin_us - frame.received_us);
    stages_.decode.add(seen.decode_us);
    stages_.resize.add(seen.resize_us);
    stages_.inference.add(seen.inference_us);
    stages_.publish.add(watch.lap_us());
    stages_.total.add(monotonic_us() - frame.received_us);
}

vdna_msg_localisation_t Daemon::use(vdna_transport *transport, const vdna_transport_frame &frame,
                                    const vdna_backbone_frame &seen, Stopwatch &watch)
{
    const vdna_select_frame live{frame.utime, seen.taps, seen.tap_count, seen.embedding};
    vdna_select_answer found;
    const vdna_status status = vdna_select_feed(selector_.get(), &live, &found);
    if (status != VDNA_OK)
        return refuse(frame, vdna_status_text(status));
    (found.newly_ranked ? stages_.rank : stages_.select).add(watch.lap_us());
    window_frames_max_ = std::max(window_frames_max_, vdna_select_window_frames(selector_.get()));

    if (found.restarted)
        std::fprintf(stderr, "vdna_selectord: camera time ran backwards, warming up again\n");
    if (found.newly_ranked)
        announce_choice(transport);
    if (!found.localised)
        return no_position(frame.utime, VDNA_MSG_LOCALISATION_T_WARMING_UP);
    return position_in(map_.experiences()[vdna_select_chosen(selector_.get())], found.match,
                       frame.utime);
}

vdna_msg_localisation_t Daemon::refuse(const vdna_transport_frame &frame, const char *reason)
{
    refused_++;
    problems_.note(monotonic_us(), "frame of utime %" PRId64 " refused: %s", frame.utime, reason);
    return no_position(frame.utime, VDNA_MSG_LOCALISATION_T_REFUSED);
}

void Daemon::announce_choice(vdna_transport *transport)
{
    const vdna_msg_ranking_t &ranking = ranking_.fill(*selector_.get());
    note_unless_sent(vdna_transport_publish(transport, config_.ranking_channel.c_str(),
                                            &vdna_message_ranking, &ranking),
                     "a ranking");
    std::fprintf(stderr,
                 "vdna_selectord: selected %s of %d after %d frames: distance %.3f bins, margin "
                 "%.3f bins\n",
                 ranking.experience[0], ranking.count, ranking.window_frames,
                 ranking.distance_bins[0], ranking.margin_bins);
}

void Daemon::publish_status(vdna_transport *transport)
{
    const Health health{*selector_.get(),
                        *vdna_transport_count(transport),
                        map_.experiences(),
                        backbone_.info(),
                        stages_,
                        refused_,
                        window_frames_max_,
                        memory_.read(),
                        problems_.last()};
    const vdna_msg_status_t message = status_of(health, wall_us());
    note_unless_sent(vdna_transport_publish(transport, config_.status_channel.c_str(),
                                            &vdna_message_status, &message),
                     "a status");
}

void Daemon::note_unless_sent(vdna_status sent, const char *what)
{
    if (sent != VDNA_OK)
        problems_.note(monotonic_us(), "%s could not be sent: %s", what, vdna_status_text(sent));
}

} // namespace vdna::selectord
