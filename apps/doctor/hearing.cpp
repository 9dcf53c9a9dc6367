#include "doctor/hearing.hpp"

#include <vdna_messages.h>

#include <vdna/cpp/connection.hpp>
#include <vdna/cpp/listener.hpp>

#include "program/clock.hpp"
#include "program/interrupt.hpp"
#include "telemetry/message_text.hpp"

namespace vdna::doctor
{

namespace
{

Connection connect_as_daemon(const Settings &settings)
{
    std::vector<const char *> sources;
    for (const std::string &source : settings.sources)
        sources.push_back(source.c_str());
    vdna_transport_config config;
    vdna_transport_config_init(&config);
    config.url = settings.url.c_str();
    config.camera_channel = settings.camera.c_str();
    config.max_image_bytes = settings.max_image_bytes;
    config.require_protection = settings.require_protection;
    config.sources = sources.data();
    config.source_count = sources.size();
    return connect(config);
}

Listener listen_for_status(const Settings &settings)
{
    const vdna_listener_channel channel{settings.status.c_str(), &vdna_message_status};
    vdna_listener_config config;
    vdna_listener_config_init(&config);
    config.url = settings.url.c_str();
    config.channels = &channel;
    config.channel_count = 1;
    return open_listener(config);
}

void take_frame(vdna_transport *transport, Heard &heard)
{
    constexpr int32_t moment_ms = 50;
    uint32_t events = 0;
    vdna_transport_frame frame{};
    if (vdna_transport_poll(transport, moment_ms, &events, &frame) != VDNA_OK)
        throw Error("the LCM connection is gone; see to the network and start again");
    if (!(events & VDNA_TRANSPORT_FRAME))
        return;
    const int64_t wall_us = frame.received_us + program::wall_us() - program::monotonic_us();
    heard.stamps.push_back({frame.utime, wall_us});
    heard.picture_bytes = frame.image.size;
}

void take_status(vdna_listener *listener, Heard &heard)
{
    vdna_listener_message message;
    while (vdna_listener_poll(listener, 0, &message) == VDNA_OK && message.type)
        if (message.data)
            heard.status = telemetry::view_of(vdna_message_status).json(message.data);
}

void listen_until_end(const Settings &settings, Heard &heard)
{
    const Connection connection = connect_as_daemon(settings);
    const Listener listener = listen_for_status(settings);
    require(vdna_transport_overhear(connection.get(), 1), settings.url);
    const int64_t begin_us = program::monotonic_us();
    while (static_cast<double>(program::monotonic_us() - begin_us) < heard.seconds * 1e6) {
        program::require_not_interrupted();
        take_frame(connection.get(), heard);
        take_status(listener.get(), heard);
    }
    heard.counters = *vdna_transport_count(connection.get());
    uint32_t count = 0;
    const vdna_transport_overheard *others =
        vdna_transport_overheard_channels(connection.get(), &count);
    heard.others.assign(others, others + count);
}

} // namespace

Heard listen(const Settings &settings, double seconds)
{
    Heard heard;
    heard.seconds = seconds;
    heard.is_log = vdna_transport_is_log(settings.url.c_str());
    if (heard.is_log)
        return heard;
    try {
        listen_until_end(settings, heard);
    } catch (const Error &error) {
        if (program::interrupted())
            throw;
        heard.refusal = error.what();
    }
    return heard;
}

} // namespace vdna::doctor
