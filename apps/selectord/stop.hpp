// SIGTERM and SIGINT: a thread receives them, so that no signal handler is needed.
#pragma once

#include <atomic>
#include <future>
#include <thread>

#include <vdna/backbone.h>

namespace vdna::selectord
{

// From now on SIGTERM and SIGINT wait for a StopOnSignal. Call before the first thread starts:
// threads inherit the mask, and a signal goes to any thread that does not block it.
void block_stop_signals();

// On a signal, cancels the running inference, and ends the process if that is not enough.
class StopOnSignal
{
  public:
    // `backbone` must outlive this object.
    explicit StopOnSignal(vdna_backbone *backbone);
    ~StopOnSignal();
    StopOnSignal(const StopOnSignal &) = delete;
    StopOnSignal &operator=(const StopOnSignal &) = delete;

    const std::atomic<bool> &requested() const { return requested_; }

  private:
    void wait();

    vdna_backbone *backbone_;
    std::atomic<bool> requested_{false};
    std::promise<void> finished_;
    std::thread thread_; // last, because it uses the members above
};

} // namespace vdna::selectord
