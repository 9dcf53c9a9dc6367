// vdna serve - runs vdna_serve, which is installed beside us, with the same arguments.
#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include <unistd.h>

#include "backbone/beside_program.hpp"
#include "program/exit_code.hpp"
#include "vdna/commands.hpp"

namespace vdna::tool
{

namespace
{

[[noreturn]] void become(const std::string &program, std::vector<std::string> arguments)
{
    arguments.insert(arguments.begin(), program);
    std::vector<char *> pointers;
    for (std::string &argument : arguments)
        pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    execv(program.c_str(), pointers.data());
    throw Error(program + ": cannot be run: " + std::strerror(errno) +
                "; install Debian's package vdna-serve, or build all programs");
}

} // namespace

void add_serve(CLI::App &app)
{
    CLI::App *command = app.add_subcommand(
        "serve",
        "Show a running vdna_selectord in a browser; runs vdna_serve, of the package vdna-serve");
    command->set_help_flag(); // all options are its own, --help too
    command->prefix_command();
    command->callback([command] {
        become(backbone::beside_program("vdna_serve").string(), command->remaining());
    });
}

} // namespace vdna::tool
