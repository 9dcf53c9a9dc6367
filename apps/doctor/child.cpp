#include "doctor/child.hpp"

#include <array>
#include <cerrno>

#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

namespace vdna::doctor
{

namespace
{

// A file without a name: a pipe would have to be read while the program runs.
class Output
{
  public:
    explicit Output(const char *name) : file_(memfd_create(name, MFD_CLOEXEC)) {}
    ~Output() { close(file_); }
    Output(const Output &) = delete;
    Output &operator=(const Output &) = delete;

    int file() const { return file_; }

    std::string text() const
    {
        std::string text;
        std::array<char, 4096> part{};
        off_t at = 0;
        for (ssize_t got; (got = pread(file_, part.data(), part.size(), at)) > 0; at += got)
            text.append(part.data(), static_cast<size_t>(got));
        return text;
    }

  private:
    int file_;
};

int wait_for(pid_t child)
{
    int status = 0;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

} // namespace

Ended run_program(const std::string &path, std::vector<std::string> arguments)
{
    arguments.insert(arguments.begin(), path);
    std::vector<char *> pointers;
    for (std::string &argument : arguments)
        pointers.push_back(argument.data());
    pointers.push_back(nullptr);

    const Output out("output"), errors("errors");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", 0, 0);
    posix_spawn_file_actions_adddup2(&actions, out.file(), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, errors.file(), STDERR_FILENO);
    pid_t child = 0;
    const int refused =
        posix_spawn(&child, path.c_str(), &actions, nullptr, pointers.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (refused != 0)
        return {};
    Ended ended;
    ended.code = wait_for(child);
    ended.out = out.text();
    ended.errors = errors.text();
    return ended;
}

} // namespace vdna::doctor
