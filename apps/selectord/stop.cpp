#include "selectord/stop.hpp"

#include <chrono>

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <vdna/cpp/error.hpp>

#include "program/exit_code.hpp"

namespace vdna::selectord
{

namespace
{

sigset_t our_signals()
{
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGTERM);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGHUP);
    return set;
}

} // namespace

StopOnSignal::StopOnSignal()
{
    const sigset_t set = our_signals();
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
    thread_ = std::thread(&StopOnSignal::wait, this);
}

StopOnSignal::~StopOnSignal()
{
    finished_.set_value();
    // Wake the thread if no signal has arrived; all other threads block it.
    // NOLINTNEXTLINE(bugprone-bad-signal-to-kill-thread,cert-pos44-c): it waits for it by sigwait()
    pthread_kill(thread_.native_handle(), SIGTERM);
    thread_.join();
}

void StopOnSignal::set(vdna_backbone *backbone)
{
    const std::lock_guard<std::mutex> guard(mutex_);
    backbone_ = backbone;
}

void StopOnSignal::wait()
{
    const sigset_t set = our_signals();
    int number;
    while (sigwait(&set, &number) == 0 && number == SIGHUP)
        reload_requested_ = true;
    requested_ = true;
    {
        const std::lock_guard<std::mutex> guard(mutex_);
        vdna_backbone_cancel(backbone_); // nothing, while there is none
    }

    // The daemon writes no files but answers, line by line: exiting in the middle leaves nothing
    // half done.
    constexpr std::chrono::milliseconds patience(100);
    if (finished_.get_future().wait_for(patience) == std::future_status::timeout)
        _exit(program::exit_ok);
}

} // namespace vdna::selectord
