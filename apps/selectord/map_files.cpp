#include "selectord/map_files.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include <vdna/cpp/error.hpp>
#include <vdna/map.h>

#include "selectord/lost_pages.hpp"

namespace vdna::selectord
{

namespace
{

bool is_same_time(const timespec &a, const timespec &b)
{
    return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec;
}

bool is_same_file(const struct stat &a, const struct stat &b)
{
    return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

bool has_same_bytes(const struct stat &a, const struct stat &b)
{
    return a.st_size == b.st_size && is_same_time(a.st_mtim, b.st_mtim);
}

// All zeros if there is no such file.
struct stat examine(const std::string &path)
{
    struct stat about{};
    if (stat(path.c_str(), &about) != 0)
        about = {};
    return about;
}

std::vector<vdna_map_file> list(const std::string &directory)
{
    vdna_error error{};
    uint32_t count = 0;
    require(vdna_map_count(directory.c_str(), &error, &count), error);
    std::vector<vdna_map_file> files(count);
    require(vdna_map_list(directory.c_str(), count, &error, files.data(), &count), error);
    files.resize(count);
    return files;
}

// -1 for what cannot be opened, which the map names and refuses or leaves out.
int open_to_watch(const std::string &path)
{
    const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0 && (errno == EMFILE || errno == ENFILE))
        throw Error(
            path + ": cannot be watched: " + std::strerror(errno) +
            "; raise `ulimit -n`, in a systemd unit LimitNOFILE=, or set [map] copy = true");
    return descriptor;
}

} // namespace

MapFiles::Descriptor::~Descriptor()
{
    if (number_ >= 0)
        close(number_);
}

MapFiles::Descriptor &MapFiles::Descriptor::operator=(Descriptor &&other) noexcept
{
    std::swap(number_, other.number_);
    return *this;
}

std::vector<MapFiles::File> MapFiles::files_of(const std::string &directory, bool mapped)
{
    std::vector<File> files;
    for (const vdna_map_file &listed : list(directory)) {
        const std::string path = directory + "/" + listed.file;
        files.push_back(
            {listed.name, path, examine(path), Descriptor(mapped ? open_to_watch(path) : -1)});
    }
    return files;
}

MapFiles::MapFiles(const std::string &directory, bool mapped)
    : directory_(directory), listed_(examine(directory).st_mtim), lost_before_(lost_pages()),
      mapped_(mapped)
{
    files_ = files_of(directory, mapped);
}

bool MapFiles::are_same(const std::vector<File> &a, const std::vector<File> &b)
{
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const File &x, const File &y) {
        return x.name == y.name && is_same_file(x.about, y.about) &&
               has_same_bytes(x.about, y.about);
    });
}

bool MapFiles::have_their_names() const
{
    return std::all_of(files_.begin(), files_.end(), [](const File &file) {
        const struct stat now = examine(file.path);
        return is_same_file(now, file.about) && has_same_bytes(now, file.about);
    });
}

// A file that was staged by an update may get its name later, so paths alone do not tell.
bool MapFiles::is_directory_changed()
{
    const timespec modified = examine(directory_).st_mtim;
    if (is_same_time(modified, listed_) && have_their_names())
        return is_changed_;
    listed_ = modified;
    try {
        is_changed_ = !are_same(files_of(directory_, false), files_);
    } catch (const Error &) {
        is_changed_ = true; // it cannot be read
    }
    return is_changed_;
}

std::string MapFiles::changed_in_place() const
{
    if (!mapped_)
        return "";
    for (const File &file : files_) {
        struct stat now{};
        if (file.descriptor.number() < 0 || fstat(file.descriptor.number(), &now) != 0)
            continue;
        const bool is_touched = !is_same_time(now.st_ctim, file.about.st_ctim) &&
                                is_same_file(examine(file.path), file.about);
        if (is_touched || !is_same_file(now, file.about) || !has_same_bytes(now, file.about))
            return file.path;
    }
    return lost_pages() != lost_before_ ? directory_ : "";
}

void MapFiles::forget(const std::string &path)
{
    for (File &file : files_)
        if (file.path == path)
            file.descriptor = Descriptor(-1);
}

} // namespace vdna::selectord
