// vdna command - sends a command to a running vdna_selectord.
#include <map>

#include <vdna_messages.h>
#include <vdna_msg_command_t.h>

#include <vdna/cpp/connection.hpp>

#include "program/clock.hpp"
#include "vdna/commands.hpp"

namespace vdna::tool
{

namespace
{

const std::map<std::string, int32_t> commands{{"reset", VDNA_MSG_COMMAND_T_RESET}};

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
    const Connection connection = connect(config);

    char no_argument[] = "";
    vdna_msg_command_t message{};
    message.utime = program::wall_us();
    message.command = commands.at(options.command);
    message.argument = no_argument;
    const vdna_status status = vdna_transport_publish(connection.get(), options.channel.c_str(),
                                                      &vdna_message_command, &message);
    if (status != VDNA_OK)
        throw Error(options.channel + ": the command cannot be sent: " + vdna_status_text(status) +
                    "; " VDNA_LCM_REMEDY);
}

} // namespace

void add_command(CLI::App &app)
{
    CLI::App *command = app.add_subcommand("command", "Send a command to a running vdna_selectord");
    const auto options = std::make_shared<CommandOptions>();
    command
        ->add_option("command", options->command,
                     "reset: forget the chosen experience and warm up again")
        ->required()
        ->check(CLI::IsMember(commands));
    command->add_option("--channel", options->channel, "channel to send on")->capture_default_str();
    command
        ->add_option("-l,--lcm-url", options->url,
                     "LCM network; default: $LCM_DEFAULT_URL, else LCM's")
        ->type_name("URL");
    command->callback([options] { send_command(*options); });
}

} // namespace vdna::tool
