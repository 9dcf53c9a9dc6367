// The sub-commands of vdna. Each function adds one to the command line; its callback does the work
// and throws vdna::Error to exit with an error message and a code.
#pragma once

#include <CLI/CLI.hpp>

namespace vdna::tool
{

void add_build(CLI::App &app);
void add_calibrate(CLI::App &app);
void add_info(CLI::App &app);
void add_rank(CLI::App &app);
void add_localise(CLI::App &app);
void add_play(CLI::App &app);
void add_watch(CLI::App &app);
void add_command(CLI::App &app);
void add_simulate(CLI::App &app);
void add_eval(CLI::App &app);
void add_metrics(CLI::App &app);
void add_model(CLI::App &app);

} // namespace vdna::tool
