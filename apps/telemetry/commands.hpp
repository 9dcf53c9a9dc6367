// The commands that vdna_selectord takes, each by its name.
#pragma once

#include <array>
#include <string>

#include <vdna/cpp/connection.hpp>

namespace vdna::telemetry
{

// Of what its argument is.
enum class Argument { none, experience, experience_or_nothing, on_or_off };

// "none", "experience", "experience or nothing", "on or off"
const char *text_of(Argument argument);

struct Command {
    const char *name;
    int32_t value; // of vdna_msg.command_t
    Argument argument;
    const char *does; // to the daemon
};

const std::array<Command, 6> &commands();

// The command of a name; nullptr if there is none.
const Command *find_command(const std::string &name);

// "unknown command" for a value that is none of them.
const char *name_of_command(int32_t value);

// Publish a command now. Returns its stamp, by which a result names it. Throws Error.
int64_t send_command(const Connection &connection, const std::string &channel,
                     const Command &command, const std::string &argument);

} // namespace vdna::telemetry
