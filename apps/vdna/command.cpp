// vdna command - sends a command to a running vdna_selectord, and waits for its result.
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "program/exit_code.hpp"
#include "vdna/commanding.hpp"
#include "vdna/commands.hpp"

namespace vdna::tool
{

namespace
{

struct CommandOptions {
    std::string command;
    std::string argument;
    Daemon daemon;
    bool no_wait = false;
};

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

void run_command(const CommandOptions &options)
{
    const telemetry::Command &command = checked_command(options);
    if (options.no_wait)
        return send_only(options.daemon, command, options.argument);
    std::cout << send_and_wait(options.daemon, command, options.argument) << std::endl;
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
    command->add_option("--channel", options->daemon.channel, "channel to send on")
        ->type_name("CHANNEL")
        ->capture_default_str();
    command
        ->add_option("--result-channel", options->daemon.result_channel, "channel of the results")
        ->type_name("CHANNEL")
        ->capture_default_str();
    command
        ->add_option("-l,--lcm-url", options->daemon.url,
                     "LCM network (default: $LCM_DEFAULT_URL, else LCM's)")
        ->type_name("URL");
    command
        ->add_option("--timeout", options->daemon.timeout_s,
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
