// The command line of vdna_selectord.
#pragma once

#include <optional>

#include "selectord/config.hpp"

namespace vdna::selectord
{

// What the daemon was asked to do.
struct Invocation {
    Config config; // defaults, overridden by the file, overridden by options
    bool print_config = false;
    bool check = false;
    bool print_memory = false;
    bool json = false; // with print_memory
};

// Nothing if --help or --version was asked for and has been answered. Throws Error.
std::optional<Invocation> read_command_line(int argc, const char *const *argv);

} // namespace vdna::selectord
