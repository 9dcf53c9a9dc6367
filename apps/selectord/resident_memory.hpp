// How much memory the process holds.
#pragma once

#include <cstdint>

namespace vdna
{

// Keeps /proc/self/statm open; reading it again allocates nothing.
class ResidentMemory
{
  public:
    ResidentMemory();
    ~ResidentMemory();
    ResidentMemory(const ResidentMemory &) = delete;
    ResidentMemory &operator=(const ResidentMemory &) = delete;

    int64_t bytes() const; // 0 if the system does not tell

  private:
    int file_;
};

} // namespace vdna
