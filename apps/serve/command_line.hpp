// The command line of vdna_serve.
#pragma once

#include <optional>
#include <string>

#include "serve/reception.hpp"
#include "usage/described.hpp"

namespace vdna::serve
{

struct Options {
    Channels channels;
    std::string command_channel = VDNA_CHANNEL_COMMAND;
    std::string address = "127.0.0.1";
    int port = 8070;
    std::string map; // directory; "" = none
};

// Nothing after answering --help or --version. Throws Error.
std::optional<Options> read_command_line(int argc, const char *const *argv);

// What it takes.
usage::Command described_command_line();

} // namespace vdna::serve
