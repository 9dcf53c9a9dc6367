#include "program/interrupt.hpp"

#include <csignal>

#include <vdna/cpp/error.hpp>

#include "program/exit_code.hpp"

namespace vdna::program
{

namespace
{

volatile std::sig_atomic_t signalled = 0;

extern "C" void remember_signal(int)
{
    signalled = 1;
}

} // namespace

void catch_interrupts()
{
    struct sigaction action = {};
    action.sa_handler = remember_signal;
    // No SA_RESTART, so that a wait ends; reset, so that a second signal ends a hanging program.
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

bool interrupted()
{
    return signalled != 0;
}

void forget_interrupt()
{
    signalled = 0;
    catch_interrupts();
}

void require_not_interrupted()
{
    if (interrupted())
        throw Interrupted("interrupted; nothing half-written is left");
}

} // namespace vdna::program
