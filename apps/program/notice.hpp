// Remarks on stderr: what a user should know about a result that stands.
#pragma once

#include <string>

namespace vdna::program
{

// Say "vdna: SENTENCE" on stderr, once per program however often it is found.
void tell_once(const std::string &sentence);

} // namespace vdna::program
