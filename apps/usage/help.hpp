// Help in one style, as wide as the terminal.
#pragma once

#include <cstddef>
#include <string>

#include "usage/described.hpp"

namespace vdna::usage
{

constexpr size_t help_width_min = 40, help_width_max = 100, help_width_usual = 80;

// Columns of the terminal on standard output: $COLUMNS, else what it says, else 80; within the
// limits.
size_t help_width();

// No line is wider than `width`, except for a word that is. An example of several lines has a
// backslash at the end of each but the last, as in a shell.
std::string help_of(const Command &command, size_t width);

// For CLI::App::formatter().
class HelpStyle : public CLI::FormatterBase
{
  public:
    std::string make_help(const CLI::App *app, std::string name,
                          CLI::AppFormatMode mode) const override;
};

} // namespace vdna::usage
