#include "usage/manual_page.hpp"

namespace vdna::usage
{

namespace
{

std::string roff(const std::string &text)
{
    std::string escaped;
    for (const char c : text) {
        if (c == '\\')
            escaped += "\\e";
        else if (c == '-')
            escaped += "\\-";
        else
            escaped += c;
    }
    return escaped;
}

std::string in_bold(const std::string &text)
{
    return "\\fB" + roff(text) + "\\fR";
}

// A line of text, which no first character turns into a request.
std::string line(const std::string &text)
{
    return "\\&" + roff(text) + "\n";
}

std::string entry(const Argument &argument)
{
    std::string names;
    const bool is_option = argument.names.front()[0] == '-';
    for (const std::string &name : argument.names)
        names += (names.empty() ? "" : ", ") +
                 (is_option ? in_bold(name) : "\\fI" + roff(name) + "\\fR");
    return ".TP\n" + names +
           (argument.value.empty() ? "" : " \\fI" + roff(argument.value) + "\\fR") +
           (argument.is_many ? "..." : "") + "\n" + line(text_of(argument));
}

std::string entries(const Command &command)
{
    std::string text;
    for (const Argument &argument : command.positionals)
        text += entry(argument);
    for (const Argument &argument : command.options)
        text += entry(argument);
    return text;
}

std::string examples(const Command &command)
{
    if (command.examples.empty())
        return "";
    std::string text = ".PP\n.nf\n";
    for (const std::string &example : command.examples)
        text += line(example);
    return text + ".fi\n";
}

std::string section(const Command &command)
{
    if (!command.commands.empty()) {
        std::string all;
        for (const Command &sub : command.commands)
            all += section(sub);
        return all;
    }
    std::string text =
        ".SS " + roff(synopsis_of(command)) + "\n" + line(command.about + ".") + entries(command);
    for (const std::string &note : command.notes)
        text += ".PP\n" + line(note);
    return text + examples(command);
}

} // namespace

std::string manual_sections(const Command &program)
{
    if (program.commands.empty())
        return ".SH OPTIONS\n" + entries(program) + ".SH EXAMPLES\n" + examples(program);
    return ".SH OPTIONS\n" + entries(program) + ".SH COMMANDS\n" + section(program);
}

} // namespace vdna::usage
