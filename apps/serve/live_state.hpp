// What the page shows, kept for whoever joins late and whoever reads slowly: of each kind of event
// only the newest, and the points of the last minutes. So a viewer costs no memory.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace vdna::serve
{

// May be used from several threads.
class LiveState
{
  public:
    using Picture = std::shared_ptr<const std::string>; // the bytes of a JPEG; null = none

    // Events that came after `seen`, as server-sent events, oldest first.
    struct News {
        uint64_t seen;
        std::string text; // empty if nothing came in time
    };

    // The newest event of a kind; `data` is one line. The same data again is no news.
    void put(const std::string &kind, const std::string &data);

    // An event "point" of the last minutes; the oldest one goes.
    void add_point(const std::string &data);

    // Wait until there is news after `seen` (0 = everything), at most for `patience`.
    News news_after(uint64_t seen, std::chrono::milliseconds patience);

    // Sleep, so that a viewer gets several events at once; close() ends it.
    void pause(std::chrono::milliseconds time);

    void set_picture(Picture picture);
    Picture picture() const;

    // From now on nobody waits.
    void close();
    bool is_closed() const;

    static constexpr size_t points_max = 300; // one a second

  private:
    struct Event {
        uint64_t number; // of the change that made it, from 1
        std::string data;
    };

    mutable std::mutex mutex_;
    std::condition_variable changed_, closing_;
    uint64_t changes_ = 0;
    bool closed_ = false;
    std::map<std::string, Event> newest_; // by kind
    std::deque<Event> points_;
    Picture picture_;
};

} // namespace vdna::serve
