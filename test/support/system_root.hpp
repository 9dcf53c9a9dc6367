// A folder that stands for the root of the system: files of /proc, /sys and /etc by their paths.
#pragma once

#include <string>

#include "folder.hpp"

class SystemRoot
{
  public:
    const std::filesystem::path &path() const { return folder_.path(); }

    // Write a file and the folders above it; `name` has no slash at its beginning.
    void write(const std::string &name, const std::string &text) const
    {
        std::filesystem::create_directories((path() / name).parent_path());
        folder_.write(name, text);
    }

  private:
    Folder folder_;
};
