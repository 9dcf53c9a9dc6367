// The command line of vdna.
#pragma once

#include <memory>

#include <CLI/CLI.hpp>

namespace vdna::tool
{

// With all sub-commands, whose callbacks do the work.
std::unique_ptr<CLI::App> command_line();

} // namespace vdna::tool
