#include "vdna/command_line.hpp"

#include <vdna/version.h>

#include "usage/described.hpp"
#include "vdna/commands.hpp"

namespace vdna::tool
{

std::unique_ptr<CLI::App> command_line()
{
    auto app = std::make_unique<CLI::App>(
        "Onboard experience selection: build maps from recorded traversals, rank them by Visual "
        "DNA, localise in them",
        "vdna");
    usage::add_standard_options(*app, std::string("vdna ") + vdna_version());
    app->require_subcommand(0, 1);
    app->footer(
        "vdna COMMAND --help lists its options. Exit codes: 0 success, 1 error in the input or "
        "the system, or a check that fails (doctor), 2 wrong usage, 3 no experience of the map "
        "fits (rank), 130 interrupted. Nothing half-written is left.\n\n"
        "Examples:\n"
        "  vdna build park winter/ summer/\n"
        "  vdna rank --warmup 42 today/ park");
#define VDNA_ADD_COMMAND(name) add_##name(*app);
    VDNA_COMMANDS(VDNA_ADD_COMMAND)
#undef VDNA_ADD_COMMAND
    return app;
}

} // namespace vdna::tool
