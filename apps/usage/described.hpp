// What a command line takes: the one description that help, manual pages and completion are made
// from.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace vdna::usage
{

struct Argument {
    std::vector<std::string> names; // "-c", "--config"; of a positional "SOURCE"
    std::string value;              // what follows an option: "FILE"; "" = nothing
    std::string type; // "DIR", "NETWORK|PATH", "SECONDS": as value, of positionals too
    std::vector<std::string> words; // all that the value may be; empty = anything of that type
    std::string about;
    std::string by_default; // "" = none
    bool is_required = false;
    bool is_many = false; // several values
};

struct Command {
    std::string name; // with those above it: "vdna model check"
    std::string about;
    std::vector<Argument> positionals, options;
    std::vector<Command> commands;
    std::vector<std::string> notes;    // paragraphs
    std::vector<std::string> examples; // command lines
    bool is_program = false;           // a program of its own parses the rest
};

// Hidden options are left out. name: as Command::name
Command described(const CLI::App &app, const std::string &name);

// A footer is paragraphs with an empty line between them; the last one is "Examples:", followed by
// a line for each, after two spaces.

// "-c, --config"
std::string names_of(const Argument &argument);

// "-c, --config FILE", "SOURCE..."
std::string heading_of(const Argument &argument);

// What it is for and, in parentheses, its default.
std::string text_of(const Argument &argument);

// "vdna build [OPTION]... MAP SOURCE..."
std::string synopsis_of(const Command &command);

// Options of each program and, of what it is given, of its sub-commands: -h, --help and, with a
// version, --version. Call it before sub-commands are added.
void add_standard_options(CLI::App &app, const std::string &version = "");

} // namespace vdna::usage
