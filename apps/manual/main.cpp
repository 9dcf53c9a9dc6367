// vdna_manual - run by the build, not installed: writes what comes with the programs, from their
// command lines: manual pages, completion for bash and zsh, and the daemon's settings with
// comments.
//
//   vdna_manual TEMPLATES OUT
//
// TEMPLATES/NAME.SECTION.in is a manual page, in which a line "@OPTIONS@" stands for all options.
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include <vdna/cpp/error.hpp>

#include "selectord/command_line.hpp"
#include "serve/command_line.hpp"
#include "usage/completion.hpp"
#include "usage/manual_page.hpp"
#include "vdna/command_line.hpp"

namespace
{

namespace fs = std::filesystem;
using vdna::usage::Command;

std::string read(const fs::path &path)
{
    std::ostringstream text;
    std::ifstream file(path);
    if (!(text << file.rdbuf()))
        throw vdna::Error(path.string() + ": cannot be read");
    return text.str();
}

void write(const fs::path &path, const std::string &text)
{
    std::ofstream file(path);
    if (!(file << text).flush())
        throw vdna::Error(path.string() + ": cannot be written");
}

std::string manual_page(const std::string &text, const Command &program)
{
    const std::string mark = "@OPTIONS@\n";
    const size_t at = text.find(mark);
    if (at == std::string::npos)
        throw vdna::Error("the page of " + program.name + " has no line " + mark);
    return text.substr(0, at) + vdna::usage::manual_sections(program) +
           text.substr(at + mark.size());
}

// Sub-commands that are programs of their own, as these describe themselves.
void complete(Command &tool, const std::vector<Command> &programs)
{
    for (Command &command : tool.commands)
        for (const Command &program : programs)
            if (command.is_program &&
                "vdna_" + command.name.substr(tool.name.size() + 1) == program.name) {
                const std::string name = command.name, about = command.about;
                command = program;
                command.name = name;
                command.about = about;
            }
}

void write_all(const fs::path &templates, const fs::path &out)
{
    const Command serve = vdna::serve::described_command_line();
    Command tool = vdna::usage::described(*vdna::tool::command_line(), "vdna");
    complete(tool, {serve});
    const std::pair<Command, std::string> programs[] = {
        {tool, "1"}, {serve, "1"}, {vdna::selectord::described_command_line(), "8"}};
    for (const auto &[program, section] : programs) {
        const std::string page = program.name + "." + section;
        write(out / page, manual_page(read(templates / (page + ".in")), program));
        write(out / (program.name + ".bash"), vdna::usage::bash_completion(program));
        write(out / ("_" + program.name), vdna::usage::zsh_completion(program));
    }
    std::ostringstream settings;
    vdna::selectord::print_config({}, settings);
    write(out / "vdna.toml", settings.str());
}

} // namespace

int main(int argc, char **argv)
{
    try {
        if (argc != 3)
            throw vdna::Error("two folders are expected: TEMPLATES OUT");
        write_all(argv[1], argv[2]);
        return 0;
    } catch (const std::exception &error) {
        std::cerr << "vdna_manual: " << error.what() << '\n';
        return 1;
    }
}
