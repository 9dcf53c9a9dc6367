// vdna command - sends a command to a running vdna_selectord.
#include <algorithm>

#include "telemetry/commands.hpp"
#include "vdna/commands.hpp"

namespace vdna::tool
{

namespace
{

struct CommandOptions {
    std::string command;
    std::string channel = VDNA_CHANNEL_COMMAND;
    std::string url;
};

void send_command(const CommandOptions &options)
{
    vdna_error error{};
    require(vdna_transport_check_channel(options.channel.c_str(), &error), error);
    vdna_transport_config config;
    vdna_transport_config_init(&config);
    config.url = options.url.empty() ? nullptr : options.url.c_str();
    const auto &all = telemetry::commands();
    telemetry::send_command(connect(config), options.channel,
                            *std::find_if(all.begin(), all.end(), [&](const auto &command) {
                                return options.command == command.name;
                            }));
}

} // namespace

void add_command(CLI::App &app)
{
    CLI::App *command = app.add_subcommand("command", "Send a command to a running vdna_selectord");
    const auto options = std::make_shared<CommandOptions>();
    std::vector<std::string> names;
    std::string help;
    for (const telemetry::Command &known : telemetry::commands()) {
        names.push_back(known.name);
        help += (help.empty() ? "" : "; ") + names.back() + ": " + known.does;
    }
    command->add_option("COMMAND", options->command, help)->required()->check(CLI::IsMember(names));
    command->add_option("--channel", options->channel, "channel to send on")
        ->type_name("CHANNEL")
        ->capture_default_str();
    command
        ->add_option("-l,--lcm-url", options->url,
                     "LCM network (default: $LCM_DEFAULT_URL, else LCM's)")
        ->type_name("URL");
    command->footer("Examples:\n"
                    "  vdna command reset");
    command->callback([options] { send_command(*options); });
}

} // namespace vdna::tool
