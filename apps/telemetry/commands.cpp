#include "telemetry/commands.hpp"

#include <vdna_messages.h>
#include <vdna_msg_command_t.h>

#include "program/clock.hpp"

namespace vdna::telemetry
{

const std::vector<Command> &commands()
{
    static const std::vector<Command> all{
        {"reset", VDNA_MSG_COMMAND_T_RESET, "forget the chosen experience and warm up again"},
    };
    return all;
}

void send_command(const Connection &connection, const std::string &channel, const Command &command)
{
    char no_argument[] = "";
    vdna_msg_command_t message{};
    message.utime = program::wall_us();
    message.command = command.value;
    message.argument = no_argument;
    const vdna_status status =
        vdna_transport_publish(connection.get(), channel.c_str(), &vdna_message_command, &message);
    if (status != VDNA_OK)
        throw Error(channel + ": the command cannot be sent: " + vdna_status_text(status) +
                    "; " VDNA_LCM_REMEDY);
}

} // namespace vdna::telemetry
