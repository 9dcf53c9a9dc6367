// A program that is run to its end.
#pragma once

#include <string>
#include <vector>

namespace vdna::doctor
{

struct Ended {
    int code = -1; // as a shell has it; -1 = it could not be run
    std::string out, errors;
};

// Run a program by its path. What it writes is kept in memory.
Ended run_program(const std::string &path, std::vector<std::string> arguments);

} // namespace vdna::doctor
