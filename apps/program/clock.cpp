#include "program/clock.hpp"

#include <cerrno>

#include <time.h>

#include "program/interrupt.hpp"

namespace vdna::program
{

namespace
{

int64_t now_us(clockid_t clock)
{
    timespec now;
    clock_gettime(clock, &now);
    return int64_t{now.tv_sec} * 1000000 + now.tv_nsec / 1000;
}

} // namespace

int64_t wall_us()
{
    return now_us(CLOCK_REALTIME);
}

int64_t monotonic_us()
{
    return now_us(CLOCK_MONOTONIC);
}

void sleep_until(int64_t due_us)
{
    const timespec due{due_us / 1000000, due_us % 1000000 * 1000};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) == EINTR)
        require_not_interrupted();
    require_not_interrupted();
}

} // namespace vdna::program
