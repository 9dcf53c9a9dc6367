// Names of files that every system and archive takes.
#pragma once

#include <set>
#include <string>

namespace vdna::report
{

// Letters, digits, '-' and '_' of ASCII; each other character becomes one '_'.
std::string portable(const std::string &name);

// Portable names of the files of one directory.
class FileNames
{
  public:
    // name made portable; "-2", "-3", ... is added if there is one of this name already, upper and
    // lower case being the same.
    std::string unique(const std::string &name);

  private:
    std::set<std::string> taken_; // in lower case
};

} // namespace vdna::report
