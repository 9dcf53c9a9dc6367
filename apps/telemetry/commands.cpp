#include "telemetry/commands.hpp"

#include <algorithm>

#include <vdna_messages.h>
#include <vdna_msg_command_t.h>

#include "program/clock.hpp"

namespace vdna::telemetry
{

const char *text_of(Argument argument)
{
    switch (argument) {
    case Argument::none:
        return "none";
    case Argument::experience:
        return "experience";
    case Argument::experience_or_nothing:
        return "experience or nothing";
    default:
        return "on or off";
    }
}

const std::array<Command, 6> &commands()
{
    static constexpr std::array<Command, 6> all{{
        {"reset", VDNA_MSG_COMMAND_T_RESET, Argument::none,
         "forget the chosen experience and warm up again"},
        {"reload", VDNA_MSG_COMMAND_T_RELOAD, Argument::none,
         "open the map again; the old map serves until the new one is checked"},
        {"pin", VDNA_MSG_COMMAND_T_PIN, Argument::experience_or_nothing,
         "localise in NAME whatever the ranking says; without NAME, in none any more"},
        {"exclude", VDNA_MSG_COMMAND_T_EXCLUDE, Argument::experience, "never choose NAME"},
        {"include", VDNA_MSG_COMMAND_T_INCLUDE, Argument::experience_or_nothing,
         "allow NAME to be chosen again; without NAME, all"},
        {"shadow", VDNA_MSG_COMMAND_T_SHADOW, Argument::on_or_off,
         "on: recommend only and keep the choice; off: act again"},
    }};
    return all;
}

const Command *find_command(const std::string &name)
{
    const auto found = std::find_if(commands().begin(), commands().end(),
                                    [&](const Command &command) { return name == command.name; });
    return found == commands().end() ? nullptr : &*found;
}

const char *name_of_command(int32_t value)
{
    const auto found = std::find_if(commands().begin(), commands().end(),
                                    [&](const Command &command) { return value == command.value; });
    return found == commands().end() ? "unknown command" : found->name;
}

int64_t send_command(const Connection &connection, const std::string &channel,
                     const Command &command, const std::string &argument)
{
    vdna_msg_command_t message{};
    message.utime = program::wall_us();
    message.command = command.value;
    message.argument = const_cast<char *>(argument.c_str()); // publishing changes nothing
    const vdna_status status =
        vdna_transport_publish(connection.get(), channel.c_str(), &vdna_message_command, &message);
    if (status != VDNA_OK)
        throw Error(channel + ": the command cannot be sent: " + vdna_status_text(status) +
                    "; " VDNA_LCM_REMEDY);
    return message.utime;
}

} // namespace vdna::telemetry
