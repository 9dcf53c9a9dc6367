// Sections of a manual page, in roff.
#pragma once

#include <string>

#include "usage/described.hpp"

namespace vdna::usage
{

// OPTIONS and EXAMPLES of a program or, if it has sub-commands, COMMANDS with all of each.
std::string manual_sections(const Command &program);

} // namespace vdna::usage
