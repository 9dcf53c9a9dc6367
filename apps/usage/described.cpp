#include "usage/described.hpp"

#include <algorithm>
#include <sstream>

#include "usage/help.hpp"

namespace vdna::usage
{

namespace
{

constexpr const char *examples_title = "Examples:";

std::string joined(const std::vector<std::string> &parts, const std::string &between)
{
    std::string text;
    for (const std::string &part : parts)
        text += (text.empty() ? "" : between) + part;
    return text;
}

// CLI11 writes the words of IsMember behind the type: "NAME:{a,b}".
std::vector<std::string> words_in(const std::string &type)
{
    const size_t begin = type.find(":{"), end = type.rfind('}');
    std::vector<std::string> words;
    if (begin == std::string::npos || end == std::string::npos)
        return words;
    std::istringstream list(type.substr(begin + 2, end - begin - 2));
    for (std::string word; std::getline(list, word, ',');)
        words.push_back(word);
    return words;
}

Argument argument_of(const CLI::Option &option)
{
    Argument argument;
    for (const std::string &name : option.get_snames())
        argument.names.push_back("-" + name);
    for (const std::string &name : option.get_lnames())
        argument.names.push_back("--" + name);
    if (argument.names.empty())
        argument.names.push_back(option.get_name(true));
    argument.about = option.get_description();
    for (const CLI::Option *other : option.get_excludes())
        argument.about += "; not with " + other->get_name();
    argument.is_required = option.get_required();
    argument.is_many = option.get_expected_max() > 1;
    if (option.get_type_size() == 0)
        return argument;
    const std::string type = option.get_type_name();
    argument.words = words_in(type);
    argument.type = type.substr(0, argument.words.empty() ? std::string::npos : type.find(":{"));
    if (argument.type == "TEXT" && !argument.words.empty())
        argument.type = joined(argument.words, "|");
    argument.value = option.get_positional() ? "" : argument.type;
    argument.by_default = option.get_default_str();
    return argument;
}

std::string trimmed(const std::string &text)
{
    const size_t begin = text.find_first_not_of(" \n"), end = text.find_last_not_of(" \n");
    return begin == std::string::npos ? "" : text.substr(begin, end - begin + 1);
}

void take_paragraph(const std::string &paragraph, Command &command)
{
    std::istringstream lines(paragraph);
    std::vector<std::string> all;
    for (std::string line; std::getline(lines, line);)
        all.push_back(trimmed(line));
    if (all.front() == examples_title)
        command.examples.assign(all.begin() + 1, all.end());
    else
        command.notes.push_back(joined(all, " "));
}

void take_footer(const std::string &footer, Command &command)
{
    const std::string text = trimmed(footer);
    for (size_t begin = 0; begin < text.size();) {
        const size_t end = std::min(text.find("\n\n", begin), text.size());
        take_paragraph(text.substr(begin, end - begin), command);
        begin = end + 2;
    }
}

} // namespace

Command described(const CLI::App &app, const std::string &name)
{
    Command command;
    command.name = name;
    command.about = app.get_description();
    command.is_program = app.get_prefix_command();
    for (const CLI::Option *option : app.get_options())
        if (!option->get_group().empty())
            (option->get_positional() ? command.positionals : command.options)
                .push_back(argument_of(*option));
    for (const CLI::App *sub : app.get_subcommands({}))
        command.commands.push_back(described(*sub, name + " " + sub->get_name()));
    take_footer(app.get_footer(), command);
    return command;
}

std::string names_of(const Argument &argument)
{
    return joined(argument.names, ", ");
}

std::string heading_of(const Argument &argument)
{
    return names_of(argument) + (argument.value.empty() ? "" : " " + argument.value) +
           (argument.is_many ? "..." : "");
}

std::string text_of(const Argument &argument)
{
    const bool is_required_option = argument.is_required && argument.names.front()[0] == '-';
    return argument.about + (is_required_option ? " (required)" : "") +
           (argument.by_default.empty() ? "" : " (default: " + argument.by_default + ")");
}

std::string synopsis_of(const Command &command)
{
    std::string text = command.name;
    if (!command.options.empty() || command.is_program)
        text += " [OPTION]...";
    for (const Argument &positional : command.positionals) {
        const std::string heading = heading_of(positional);
        text += " " + (positional.is_required ? heading : "[" + heading + "]");
    }
    return text + (command.commands.empty() ? "" : " COMMAND ...");
}

void add_standard_options(CLI::App &app, const std::string &version)
{
    app.formatter(std::make_shared<HelpStyle>());
    app.set_help_flag("-h,--help", "print this help and exit");
    if (!version.empty())
        app.set_version_flag("--version", version, "print the version and exit");
}

} // namespace vdna::usage
