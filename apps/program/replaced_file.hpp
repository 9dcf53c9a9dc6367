// Files that are replaced at once or not at all.
#pragma once

#include <string>

namespace vdna::program
{

enum class Durability {
    quick,   // a loss of power may cost the file: for what can be made again and checks itself
    durable, // a loss of power leaves the old file or the new one
};

// Write a file beside the old one and rename it when it is complete. Throws Error.
void replace_file(const std::string &path, const std::string &bytes,
                  Durability durability = Durability::durable);

} // namespace vdna::program
