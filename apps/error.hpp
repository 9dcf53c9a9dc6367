// How the programs end: exit codes, and the exception that carries a sentence for people.
#pragma once

#include <stdexcept>
#include <string>

#include <vdna/status.h>

namespace vdna
{

enum ExitCode {
    exit_ok = 0,
    exit_failed = 1, // the input or the system did not allow it; nothing half-written is left
    exit_usage = 2,  // the command line or a configuration file is wrong
    exit_interrupted = 130, // Ctrl-C or SIGTERM; nothing half-written is left
};

// Ends the program: what() is printed after the program's name as the one error line.
class Error : public std::runtime_error
{
  public:
    explicit Error(const std::string &sentence, ExitCode code = exit_failed)
        : std::runtime_error(sentence), code_(code)
    {
    }
    ExitCode code() const { return code_; }

  private:
    ExitCode code_;
};

// Throw unless a call of the C ABI went well.
inline void require(vdna_status status, const vdna_error &error)
{
    if (status != VDNA_OK)
        throw Error(error.text);
}

} // namespace vdna
