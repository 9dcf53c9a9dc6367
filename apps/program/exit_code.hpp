// Exit codes of the programs.
#pragma once

#include <exception>

#include <vdna/cpp/error.hpp>

namespace vdna::program
{

enum ExitCode {
    exit_ok = 0,
    exit_failed = 1,        // error in the input or the system; nothing half-written is left
    exit_usage = 2,         // the command line or a configuration file is wrong
    exit_none_fits = 3,     // the result is complete, and says that no experience fits the live run
    exit_interrupted = 130, // Ctrl-C or SIGTERM; nothing half-written is left
};

// The command line or a configuration file is wrong.
class UsageError : public Error
{
  public:
    using Error::Error;
};

// Ctrl-C or SIGTERM interrupted the work.
class Interrupted : public Error
{
  public:
    using Error::Error;
};

// The result has been written, and says that no experience fits the live run: no error.
struct NoneFits : std::exception {
};

inline ExitCode exit_code_of(const Error &error)
{
    if (dynamic_cast<const UsageError *>(&error))
        return exit_usage;
    return dynamic_cast<const Interrupted *>(&error) ? exit_interrupted : exit_failed;
}

} // namespace vdna::program
