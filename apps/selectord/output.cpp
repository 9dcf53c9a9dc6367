#include "selectord/output.hpp"

#include <string>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace vdna::selectord
{

namespace
{

void never_wait(int output)
{
    struct stat status;
    if (fstat(output, &status) != 0)
        return;
    // A socket cannot be opened again; that of systemd's journal is ours alone.
    if (S_ISSOCK(status.st_mode))
        fcntl(output, F_SETFL, fcntl(output, F_GETFL) | O_NONBLOCK);
    if (!S_ISFIFO(status.st_mode) && !S_ISCHR(status.st_mode))
        return;
    // Opened again, a pipe or a terminal has flags of its own, which its other users do not see.
    const std::string path = "/proc/self/fd/" + std::to_string(output);
    const int again = open(path.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (again < 0)
        return;
    dup2(again, output);
    close(again);
}

} // namespace

void never_wait_for_readers()
{
    never_wait(STDOUT_FILENO);
    never_wait(STDERR_FILENO);
}

} // namespace vdna::selectord
