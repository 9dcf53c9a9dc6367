// Completion of command lines in shells: sub-commands, options, and the values that are known,
// which are few words, files, folders and, for values of the type NETWORK, the networks that are
// installed.
#pragma once

#include <string>

#include "usage/described.hpp"

namespace vdna::usage
{

// A file to be sourced, for bash-completion under the program's name.
std::string bash_completion(const Command &program);

// A file _PROGRAM of zsh's fpath.
std::string zsh_completion(const Command &program);

} // namespace vdna::usage
