#include "usage/help.hpp"

#include <algorithm>
#include <cstdlib>

#include <sys/ioctl.h>
#include <unistd.h>

namespace vdna::usage
{

namespace
{

// Length of the part of text[begin..] that fits `room` columns: up to a space or, in what is
// longer, behind a '|' or ','; a word without any is not broken.
size_t fitting(const std::string &text, size_t begin, size_t room)
{
    if (text.size() - begin <= room)
        return text.size() - begin;
    const size_t space = text.rfind(' ', begin + room);
    if (space != std::string::npos && space > begin)
        return space - begin;
    const size_t bar = text.find_last_of("|,", begin + room - 1);
    if (bar != std::string::npos && bar >= begin)
        return bar + 1 - begin;
    const size_t next = text.find_first_of(" |,", begin);
    if (next == std::string::npos)
        return text.size() - begin;
    return next + (text[next] == ' ' ? 0 : 1) - begin;
}

// The text in lines of at most `width` columns: the first goes on in column `column`, the others
// are indented by `indent`; `end` ends each but the last.
std::string wrapped(const std::string &text, size_t width, size_t indent, size_t column,
                    const std::string &end = "")
{
    std::string lines;
    for (size_t begin = 0; begin < text.size();) {
        const size_t left = text.size() - begin;
        const size_t room = width - (lines.empty() ? column : indent);
        const size_t length = left <= room ? left : fitting(text, begin, room - end.size());
        lines += (lines.empty() ? "" : end + "\n" + std::string(indent, ' ')) +
                 text.substr(begin, length);
        begin += length;
        begin += begin < text.size() && text[begin] == ' ';
    }
    return lines + "\n";
}

std::string entry(const std::string &heading, const std::string &text, size_t width)
{
    constexpr size_t margin = 2, gap = 2;
    const size_t column = std::min<size_t>(26, width / 3);
    std::string lines = "  " + wrapped(heading, width, 2 * margin, margin);
    if (text.empty())
        return lines;
    const bool is_short = margin + heading.size() + gap <= column;
    if (is_short)
        lines.back() = ' ';
    const size_t used = is_short ? lines.size() : 0;
    return lines + std::string(column - used, ' ') + wrapped(text, width, column, column);
}

std::string entries(const std::string &title, const std::vector<Argument> &arguments, size_t width)
{
    std::string lines = arguments.empty() ? "" : "\n" + title + ":\n";
    for (const Argument &argument : arguments)
        lines += entry(heading_of(argument), text_of(argument), width);
    return lines;
}

} // namespace

size_t help_width()
{
    size_t width = help_width_usual;
    winsize window = {};
    const char *columns = std::getenv("COLUMNS");
    if (const unsigned long given = columns ? std::strtoul(columns, nullptr, 10) : 0; given > 0)
        width = given;
    else if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 0)
        width = window.ws_col;
    return std::clamp(width, help_width_min, help_width_max);
}

std::string help_of(const Command &command, size_t width)
{
    constexpr size_t usage_indent = 7; // behind "Usage: "
    std::string text =
        "Usage: " + wrapped(synopsis_of(command), width, usage_indent, usage_indent) + "\n" +
        wrapped(command.about, width, 0, 0);
    text += entries("Arguments", command.positionals, width);
    text += entries("Options", command.options, width);
    if (!command.commands.empty())
        text += "\nCommands:\n";
    for (const Command &sub : command.commands)
        text += entry(sub.name.substr(command.name.size() + 1), sub.about, width);
    for (const std::string &note : command.notes)
        text += "\n" + wrapped(note, width, 0, 0);
    if (!command.examples.empty())
        text += "\nExamples:\n";
    for (const std::string &example : command.examples)
        text += "  " + wrapped(example, width, 6, 2, " \\");
    return text;
}

std::string HelpStyle::make_help(const CLI::App *app, std::string name, CLI::AppFormatMode) const
{
    return help_of(described(*app, name), help_width());
}

} // namespace vdna::usage
