// Commands to a running vdna_selectord, and what becomes of them.
#pragma once

#include <string>

#include "telemetry/commands.hpp"

namespace vdna::tool
{

// How to reach it.
struct Daemon {
    std::string url; // LCM network; "" = LCM's default
    std::string channel = VDNA_CHANNEL_COMMAND;
    std::string result_channel = VDNA_CHANNEL_COMMAND_RESULT;
    double timeout_s = 10; // to wait for a result
};

// Throws Error.
void send_only(const Daemon &daemon, const telemetry::Command &command,
               const std::string &argument);

// Send a command; returns what became of it, with the hash of the map. Throws Error if it was
// refused, or not answered in time.
std::string send_and_wait(const Daemon &daemon, const telemetry::Command &command,
                          const std::string &argument);

} // namespace vdna::tool
