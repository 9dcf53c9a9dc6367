// Clocks, in microseconds.
#pragma once

#include <cstdint>

namespace vdna::program
{

// Time of day, since 1970.
int64_t wall_us();

// Time that no one sets, since an arbitrary moment.
int64_t monotonic_us();

// Sleep until monotonic_us() is `due_us`. Throws Error on Ctrl-C.
void sleep_until(int64_t due_us);

} // namespace vdna::program
