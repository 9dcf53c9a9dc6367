// Atomic replacement of files, and directories for them.
#pragma once

#include <string>

namespace vdna::program
{

enum class Durability {
    quick,   // a power loss may destroy the file: for files that are checked on reading and can be
             // rebuilt
    durable, // a power loss leaves the old file or the new one
};

// Write a file next to the old one and rename it when it is complete. Throws Error.
void replace_file(const std::string &path, const std::string &bytes,
                  Durability durability = Durability::durable);

// Made with those above it, unless it is there. Throws Error.
void make_directory(const std::string &directory);

} // namespace vdna::program
