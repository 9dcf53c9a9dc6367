#include "read_file.hpp"

#include "open_file.hpp"

namespace vdna::backbone
{

std::string read_file(const std::filesystem::path &file, size_t limit)
{
    OpenFile open(file, limit);
    std::string bytes(open.size(), '\0');
    bytes.resize(open.read(bytes.data(), bytes.size()));
    return bytes;
}

} // namespace vdna::backbone
