// vdna command - sends a command to a running vdna_selectord, and waits for its result.
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <vdna_messages.h>
#include <vdna_msg_command_result_t.h>

#include <vdna/listener.h>

#include "program/clock.hpp"
#include "program/exit_code.hpp"
#include "program/interrupt.hpp"
#include "telemetry/commands.hpp"
#include "vdna/commands.hpp"

namespace vdna::tool
{

namespace
{

struct CommandOptions {
    std::string command;
    std::string argument;
    std::string channel = VDNA_CHANNEL_COMMAND;
    std::string result_channel = VDNA_CHANNEL_COMMAND_RESULT;
    std::string url;
    double timeout_s = 10;
    bool no_wait = false;
};

struct CloseListener {
    void operator()(vdna_listener *listener) const { vdna_listener_close(listener); }
};
using Listener = std::unique_ptr<vdna_listener, CloseListener>;

const char *or_null(const std::string &url)
{
    return url.empty() ? nullptr : url.c_str();
}

// The command, if its argument is one that it may have. Throws UsageError.
const telemetry::Command &checked_command(const CommandOptions &options)
{
    using telemetry::Argument;
    const telemetry::Command &command = *telemetry::find_command(options.command);
    const bool is_given = !options.argument.empty();
    if (command.argument == Argument::none && is_given)
        throw program::UsageError(options.command + " takes no argument, but got " +
                                  options.argument);
    if (command.argument == Argument::experience && !is_given)
        throw program::UsageError(options.command + " needs the name of an experience");
    if (command.argument == Argument::on_or_off && options.argument != "on" &&
        options.argument != "off")
        throw program::UsageError(options.command + " needs on or off" +
                                  (is_given ? ", but got " + options.argument : ""));
    return command;
}

Listener listen_for_results(const CommandOptions &options)
{
    const vdna_listener_channel results{options.result_channel.c_str(),
                                        &vdna_message_command_result};
    vdna_listener_config config;
    vdna_listener_config_init(&config);
    config.url = or_null(options.url);
    config.channels = &results;
    config.channel_count = 1;
    vdna_listener *listener = nullptr;
    vdna_error error{};
    require(vdna_listener_open(&config, &error, &listener), error);
    return Listener(listener);
}

// Print the result of the command sent at `utime`. Throws Error if it was refused, or none comes.
void await_result(vdna_listener *listener, int64_t utime, const CommandOptions &options)
{
    constexpr int32_t moment_ms = 100;
    const int64_t begin_us = program::monotonic_us();
    const auto is_time_left = [&] {
        return static_cast<double>(program::monotonic_us() - begin_us) < 1e6 * options.timeout_s;
    };
    while (is_time_left() && !program::interrupted()) {
        vdna_listener_message message;
        if (vdna_listener_poll(listener, moment_ms, &message) != VDNA_OK)
            throw Error("the LCM connection is gone; see to the network and try again");
        const auto *const result = static_cast<const vdna_msg_command_result_t *>(message.data);
        if (!result || result->utime != utime)
            continue;
        if (!result->accepted)
            throw Error("refused: " + std::string(result->text) + " (map " + result->map_hash +
                        ")");
        std::cout << result->text << " (map " << result->map_hash << ")" << std::endl;
        return;
    }
    throw Error("no vdna_selectord has answered on " + options.result_channel +
                "; is one running on this LCM network? See `vdna watch`, or wait longer by "
                "--timeout");
}

void run_command(const CommandOptions &options)
{
    const telemetry::Command &command = checked_command(options);
    vdna_error error{};
    require(vdna_transport_check_channel(options.channel.c_str(), &error), error);
    vdna_transport_config config;
    vdna_transport_config_init(&config);
    config.url = or_null(options.url);
    const Listener results = options.no_wait ? nullptr : listen_for_results(options);
    const int64_t utime =
        telemetry::send_command(connect(config), options.channel, command, options.argument);
    if (results)
        await_result(results.get(), utime, options);
}

} // namespace

void add_command(CLI::App &app)
{
    CLI::App *command = app.add_subcommand(
        "command", "Send a command to a running vdna_selectord, and print what became of it");
    const auto options = std::make_shared<CommandOptions>();
    std::vector<std::string> names;
    std::string help;
    for (const telemetry::Command &known : telemetry::commands()) {
        names.push_back(known.name);
        help += (help.empty() ? "" : "; ") + names.back() + ": " + known.does;
    }
    command->add_option("COMMAND", options->command, help)->required()->check(CLI::IsMember(names));
    command
        ->add_option("ARGUMENT", options->argument, "name of an experience; for shadow on or off")
        ->type_name("NAME");
    command->add_option("--channel", options->channel, "channel to send on")
        ->type_name("CHANNEL")
        ->capture_default_str();
    command->add_option("--result-channel", options->result_channel, "channel of the results")
        ->type_name("CHANNEL")
        ->capture_default_str();
    command
        ->add_option("-l,--lcm-url", options->url,
                     "LCM network (default: $LCM_DEFAULT_URL, else LCM's)")
        ->type_name("URL");
    command
        ->add_option("--timeout", options->timeout_s,
                     "seconds to wait for the result; a reload reads the whole map")
        ->check(CLI::Range(0.0, 1e6).description(""))
        ->type_name("SECONDS")
        ->capture_default_str();
    command->add_flag("--no-wait", options->no_wait, "send, and do not wait for the result");
    command->footer("Exit code 1 if the command is refused or not answered.\n\n"
                    "Examples:\n"
                    "  vdna command reset\n"
                    "  vdna command pin winter --timeout 30");
    command->callback([options] { run_command(*options); });
}

} // namespace vdna::tool
