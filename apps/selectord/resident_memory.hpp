// Resident memory of the process.
#pragma once

#include <cstdint>

namespace vdna::selectord
{

// In bytes; 0 if the system does not tell.
struct Resident {
    int64_t now = 0;
    int64_t anonymous = 0; // of that, not backed by a file
    int64_t most = 0;      // since the process began
};

// Keeps /proc/self/status open; reading it again allocates nothing.
class ResidentMemory
{
  public:
    ResidentMemory();
    ~ResidentMemory();
    ResidentMemory(const ResidentMemory &) = delete;
    ResidentMemory &operator=(const ResidentMemory &) = delete;

    Resident read() const;

  private:
    int file_;
};

} // namespace vdna::selectord
