// SIGTERM, SIGINT and SIGHUP: a thread receives them, so that no signal handler is needed.
#pragma once

#include <atomic>
#include <future>
#include <mutex>
#include <thread>

#include <vdna/backbone.h>

namespace vdna::selectord
{

// On SIGTERM and SIGINT, cancels the running inference, and ends the process if that is not enough:
// while it starts, or decodes a huge picture, which cannot be cancelled.
class StopOnSignal
{
  public:
    // From now on these signals come here. Construct it before the first thread starts:
    // threads inherit the mask, and a signal goes to any thread that does not block it.
    StopOnSignal();
    ~StopOnSignal();
    StopOnSignal(const StopOnSignal &) = delete;
    StopOnSignal &operator=(const StopOnSignal &) = delete;

    const std::atomic<bool> &requested() const { return requested_; }
    // SIGHUP sets it; whoever reloads the map takes it back.
    std::atomic<bool> &reload_requested() { return reload_requested_; }

    // A signal to stop cancels this network as long as the object lives.
    class Cancels
    {
      public:
        Cancels(StopOnSignal &stop, vdna_backbone *backbone) : stop_(stop) { stop.set(backbone); }
        ~Cancels() { stop_.set(nullptr); }
        Cancels(const Cancels &) = delete;
        Cancels &operator=(const Cancels &) = delete;

      private:
        StopOnSignal &stop_;
    };

  private:
    void set(vdna_backbone *backbone);
    void wait();

    std::mutex mutex_;
    vdna_backbone *backbone_ = nullptr; // guarded by the mutex
    std::atomic<bool> requested_{false}, reload_requested_{false};
    std::promise<void> finished_;
    std::thread thread_; // last, because it uses the members above
};

} // namespace vdna::selectord
