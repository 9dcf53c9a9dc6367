// The sub-commands of vdna. Each function, add_build() and so on, adds one to the command line; its
// callback does the work and throws vdna::Error to end with a sentence and an exit code.
#pragma once

#include <CLI/CLI.hpp>

#include "command_list.hpp"

namespace vdna::tool
{

#define VDNA_ADD_COMMAND(name) void add_##name(CLI::App &app);
VDNA_COMMANDS(VDNA_ADD_COMMAND)
#undef VDNA_ADD_COMMAND

} // namespace vdna::tool
