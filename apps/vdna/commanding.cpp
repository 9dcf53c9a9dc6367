#include "vdna/commanding.hpp"

#include <vdna_messages.h>
#include <vdna_msg_command_result_t.h>

#include <vdna/cpp/connection.hpp>
#include <vdna/cpp/listener.hpp>

#include "program/clock.hpp"
#include "program/interrupt.hpp"

namespace vdna::tool
{

namespace
{

Listener listen_for_results(const Daemon &daemon)
{
    const vdna_listener_channel results{daemon.result_channel.c_str(),
                                        &vdna_message_command_result};
    vdna_listener_config config;
    vdna_listener_config_init(&config);
    config.url = url_or_default(daemon.url);
    config.channels = &results;
    config.channel_count = 1;
    return open_listener(config);
}

// Returns the stamp by which a result names it.
int64_t send(const Daemon &daemon, const telemetry::Command &command, const std::string &argument)
{
    vdna_error error{};
    require(vdna_transport_check_channel(daemon.channel.c_str(), &error), error);
    return telemetry::send_command(connect_to_send(daemon.url), daemon.channel, command, argument);
}

// The result of the command sent at `utime`.
std::string await_result(vdna_listener *listener, int64_t utime, const Daemon &daemon)
{
    constexpr int32_t moment_ms = 100;
    const int64_t begin_us = program::monotonic_us();
    const auto is_time_left = [&] {
        return static_cast<double>(program::monotonic_us() - begin_us) < 1e6 * daemon.timeout_s;
    };
    while (is_time_left() && !program::interrupted()) {
        vdna_listener_message message;
        if (vdna_listener_poll(listener, moment_ms, &message) != VDNA_OK)
            throw Error("the LCM connection is gone; see to the network and try again");
        const auto *const result = static_cast<const vdna_msg_command_result_t *>(message.data);
        if (!result || result->utime != utime)
            continue;
        const std::string text = result->text + std::string(" (map ") + result->map_hash + ")";
        if (!result->accepted)
            throw Error("refused: " + text);
        return text;
    }
    throw Error("no vdna_selectord has answered on " + daemon.result_channel +
                "; is one running on this LCM network? See `vdna watch`, or wait longer by "
                "--timeout");
}

} // namespace

void send_only(const Daemon &daemon, const telemetry::Command &command, const std::string &argument)
{
    send(daemon, command, argument);
}

std::string send_and_wait(const Daemon &daemon, const telemetry::Command &command,
                          const std::string &argument)
{
    const Listener results = listen_for_results(daemon);
    return await_result(results.get(), send(daemon, command, argument), daemon);
}

} // namespace vdna::tool
