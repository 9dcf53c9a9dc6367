#include "open_file.hpp"

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "failure.hpp"

namespace vdna::backbone
{

OpenFile::OpenFile(std::filesystem::path file, size_t limit)
    : name_(std::move(file)), stream_(std::fopen(name_.c_str(), "rbe"), std::fclose)
{
    if (!stream_ || fstat(descriptor(), &about_) != 0)
        refused_by_system();
    // A directory, a pipe or a device has no size to trust.
    if (!S_ISREG(about_.st_mode))
        throw fail::Failure(VDNA_ERR_IO, name_.string() + ": is not a regular file");
    if (size() > limit)
        throw fail::Failure(VDNA_ERR_FORMAT, name_.string() + ": has " + std::to_string(size()) +
                                                 " bytes; at most " + std::to_string(limit) +
                                                 " are expected");
}

void OpenFile::refused_by_system() const
{
    throw fail::Failure(VDNA_ERR_IO, name_.string() + ": cannot be read: " + std::strerror(errno));
}

size_t OpenFile::read(char *bytes, size_t room)
{
    const size_t count = std::fread(bytes, 1, room, stream_.get());
    if (std::ferror(stream_.get()))
        refused_by_system();
    return count;
}

void OpenFile::require_unchanged() const
{
    struct stat now{};
    if (fstat(descriptor(), &now) != 0)
        refused_by_system();
    // Any write sets the time of the last change, and nobody can set it back.
    if (now.st_ctim.tv_sec != about_.st_ctim.tv_sec ||
        now.st_ctim.tv_nsec != about_.st_ctim.tv_nsec)
        throw fail::Failure(VDNA_ERR_IO,
                            name_.string() + ": changed while it was read; try it again");
}

} // namespace vdna::backbone
