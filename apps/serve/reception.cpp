#include "serve/reception.hpp"

#include <vdna_messages.h>

#include "program/clock.hpp"
#include "telemetry/headline.hpp"
#include "telemetry/network_url.hpp"
#include "telemetry/problems.hpp"

namespace vdna::serve
{

namespace
{

constexpr int32_t moment_ms = 50;
constexpr int64_t second_us = 1000000;
constexpr int64_t picture_every_us = second_us / 4;
constexpr size_t rate_seconds = 3; // over which the camera's rate is taken

Connection open_camera(const Channels &channels)
{
    vdna_transport_config config;
    vdna_transport_config_init(&config);
    config.url = url_or_default(channels.url);
    config.camera_channel = channels.camera.c_str();
    return connect(config);
}

Listener listen_to_views(const Channels &channels)
{
    const std::vector<telemetry::View> &views = telemetry::views();
    std::vector<vdna_listener_channel> wanted;
    for (size_t i = 0; i < views.size(); i++)
        wanted.push_back({channels.views[i].c_str(), views[i].type});
    vdna_listener_config config;
    vdna_listener_config_init(&config);
    config.url = url_or_default(channels.url);
    config.queue_length = VDNA_TRANSPORT_QUEUE; // we are quick, and need only the newest
    config.channels = wanted.data();
    config.channel_count = static_cast<uint32_t>(wanted.size());
    return open_listener(config);
}

double seconds_since(int64_t us)
{
    return static_cast<double>(program::monotonic_us() - us) / second_us;
}

nlohmann::ordered_json age(int64_t us)
{
    return us > 0 ? nlohmann::ordered_json(seconds_since(us)) : nullptr;
}

void require_network(vdna_status status)
{
    if (status == VDNA_ERR_IO)
        throw Error("the LCM connection is gone; see to the network and start again");
    if (status != VDNA_OK)
        throw Error(std::string("LCM: ") + vdna_status_text(status));
}

} // namespace

Reception::Reception(const Channels &channels, LiveState &state)
    : state_(state), camera_(open_camera(channels)), listener_(listen_to_views(channels)),
      url_(telemetry::network_url(channels.url)), newest_(program::monotonic_us())
{
}

void Reception::put(const char *kind, const Json &json)
{
    state_.put(kind, json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

void Reception::put_headline()
{
    const telemetry::Headline line = telemetry::headline(
        newest_.status(), newest_.ranking(), newest_.silent_s(program::monotonic_us()), url_);
    put("headline", {{"tone", line.tone}, {"text", line.text}});
}

void Reception::take(const vdna_listener_message &message)
{
    if (message.rejected)
        newest_.note_rejected(message.channel, message.rejected);
    if (!message.data)
        return;
    const bool had_choice = !newest_.ranking().is_null() || !newest_.localisation().is_null();
    const telemetry::View &view = telemetry::view_of(*message.type);
    if (message.type == &vdna_message_command_result)
        return put("result", view.json(message.data));
    if (!newest_.take(view.name, view.json(message.data), program::monotonic_us()))
        return;
    if (message.type == &vdna_message_localisation) {
        answer_ = newest_.localisation();
        put("localisation", answer_);
        return;
    }
    if (message.type == &vdna_message_status) {
        put("status", newest_.status());
        put("problems", telemetry::problems_of(newest_.status()));
    }
    if (had_choice || !newest_.ranking().is_null()) // a status may end what was said before
        put("ranking", newest_.ranking());
    if (had_choice)
        put("localisation", newest_.localisation());
    put_headline();
}

void Reception::take(const vdna_transport_frame &frame)
{
    picture_us_ = program::monotonic_us();
    Json json{{"utime", frame.utime}, {"problem", nullptr}};
    try {
        state_.set_picture(std::make_shared<const std::string>(jpeg_.of(frame.image)));
    } catch (const Error &error) {
        state_.set_picture(nullptr);
        json["problem"] = error.what();
    }
    put("picture", json);
}

double Reception::camera_hz() const
{
    const Count &first = counts_.front(), &last = counts_.back();
    return last.us > first.us ? static_cast<double>(last.frames - first.frames) * second_us /
                                    static_cast<double>(last.us - first.us)
                              : 0;
}

void Reception::each_second(size_t viewers)
{
    const vdna_transport_counters *const counted = vdna_transport_count(camera_.get());
    counts_.push_back({second_us_, counted->received});
    if (counts_.size() > rate_seconds + 1)
        counts_.pop_front();
    put("pulse", {{"utime", program::wall_us()},
                  {"status_age_s", age(newest_.status_us())},
                  {"camera_age_s", age(frame_us_)},
                  {"camera_hz", camera_hz()},
                  {"camera_oversized", counted->oversized},
                  {"camera_rejected", counted->camera_rejected},
                  {"left_out", newest_.rejected()},
                  {"viewers", viewers}});
    Json point{{"utime", program::wall_us()}};
    for (const char *const name : {"validity", "experience", "confidence", "frame"})
        point[name] = answer_.is_object() ? answer_[name] : Json();
    answer_ = nullptr;
    state_.add_point(point.dump(-1, ' ', false, Json::error_handler_t::replace));
    put_headline();
}

void Reception::run_once(size_t viewers)
{
    uint32_t events = 0;
    vdna_transport_frame frame;
    require_network(vdna_transport_poll(camera_.get(), moment_ms, &events, &frame));
    const int64_t now = program::monotonic_us();
    if (events & VDNA_TRANSPORT_FRAME) {
        frame_us_ = now;
        if (viewers > 0 && now - picture_us_ >= picture_every_us)
            take(frame);
    }
    for (vdna_listener_message message;;) {
        require_network(vdna_listener_poll(listener_.get(), 0, &message));
        if (!message.type)
            break;
        take(message);
    }
    if (now - second_us_ >= second_us) {
        second_us_ = now;
        each_second(viewers);
    }
}

} // namespace vdna::serve
