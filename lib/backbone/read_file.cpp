#include "read_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <sys/stat.h>

#include "failure.hpp"

namespace vdna
{

namespace
{

[[noreturn]] void refused_by_system(const std::filesystem::path &file)
{
    throw Failure(VDNA_ERR_IO, file.string() + ": cannot be read: " + std::strerror(errno));
}

} // namespace

std::string read_file(const std::filesystem::path &file, size_t limit)
{
    const std::unique_ptr<FILE, int (*)(FILE *)> stream(std::fopen(file.c_str(), "rbe"),
                                                        std::fclose);
    struct stat about{};
    if (!stream || fstat(fileno(stream.get()), &about) != 0)
        refused_by_system(file);
    // A directory, a pipe or a device has no size to trust.
    if (!S_ISREG(about.st_mode))
        throw Failure(VDNA_ERR_IO, file.string() + ": is not a regular file");
    const auto size = static_cast<size_t>(about.st_size);
    if (size > limit)
        throw Failure(VDNA_ERR_FORMAT, file.string() + ": has " + std::to_string(size) +
                                           " bytes; at most " + std::to_string(limit) +
                                           " are expected");

    std::string bytes(size, '\0');
    if (std::fread(bytes.data(), 1, size, stream.get()) != size)
        refused_by_system(file);
    return bytes;
}

} // namespace vdna
