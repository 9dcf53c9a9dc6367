// Resident memory of a process.
#pragma once

#include <cstdint>

#include <sys/types.h>

namespace vdna::selectord
{

// In bytes; 0 if the system does not tell.
struct Resident {
    int64_t now = 0;
    int64_t anonymous = 0; // of that, not backed by a file
    int64_t most = 0;      // since the process began

    Resident &operator+=(const Resident &other)
    {
        now += other.now;
        anonymous += other.anonymous;
        most += other.most;
        return *this;
    }
};

// Keeps /proc/PID/status open; reading it again allocates nothing.
class ResidentMemory
{
  public:
    ResidentMemory(); // of this process
    explicit ResidentMemory(pid_t process);
    ~ResidentMemory();
    ResidentMemory(const ResidentMemory &) = delete;
    ResidentMemory &operator=(const ResidentMemory &) = delete;

    Resident read() const;

  private:
    int file_;
};

} // namespace vdna::selectord
