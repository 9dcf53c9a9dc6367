// The command line of vdna_selectord.
#pragma once

#include <optional>
#include <string>

#include "selectord/config.hpp"
#include "usage/described.hpp"

namespace vdna::selectord
{

// The task of the daemon.
struct Invocation {
    Config config; // defaults, overridden by the file, then by options
    bool print_config = false;
    bool check = false;
    bool print_memory = false;
    bool json = false;   // with print_memory
    std::string answers; // file; "" = none
};

// Nothing after answering --help or --version. Throws Error.
std::optional<Invocation> read_command_line(int argc, const char *const *argv);

// What it takes.
usage::Command described_command_line();

} // namespace vdna::selectord
