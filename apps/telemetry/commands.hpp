// The commands that vdna_selectord takes, each by its name.
#pragma once

#include <string>
#include <vector>

#include <vdna/cpp/connection.hpp>

namespace vdna::telemetry
{

struct Command {
    const char *name;
    int32_t value;    // of vdna_msg.command_t
    const char *does; // to the daemon
};

const std::vector<Command> &commands();

// Publish a command now. Throws Error.
void send_command(const Connection &connection, const std::string &channel, const Command &command);

} // namespace vdna::telemetry
