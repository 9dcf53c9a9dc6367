#include "selectord/answer_file.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <vdna/cpp/error.hpp>

namespace vdna::selectord
{

namespace
{

// Whether a file holds anything but lines of JSON: a log or a map, named by mistake.
bool holds_something_else(int file)
{
    struct stat about;
    char first;
    return fstat(file, &about) == 0 && S_ISREG(about.st_mode) && pread(file, &first, 1, 0) == 1 &&
           first != '{';
}

} // namespace

AnswerFile::AnswerFile(const std::string &path)
    : path_(path), file_(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666))
{
    if (file_ < 0)
        give_up("opened");
    if (holds_something_else(file_)) {
        close(file_);
        throw Error(path + ": exists and holds no answers, expected an empty or a new file, or one "
                           "of --answers; name another one");
    }
    // What cannot be cut, such as a pipe, has nothing to lose.
    if (ftruncate(file_, 0) != 0 && errno != EINVAL) {
        close(file_);
        give_up("emptied");
    }
}

AnswerFile::~AnswerFile()
{
    close(file_);
}

void AnswerFile::give_up(const char *what) const
{
    throw Error(path_ + ": cannot be " + what + ": " + std::strerror(errno) +
                "; free some space or name another file for --answers");
}

void AnswerFile::write(std::string line)
{
    line += '\n';
    for (size_t done = 0; done < line.size();) {
        const ssize_t written = ::write(file_, line.data() + done, line.size() - done);
        if (written > 0)
            done += static_cast<size_t>(written);
        else if (errno != EINTR)
            give_up("written");
    }
}

} // namespace vdna::selectord
