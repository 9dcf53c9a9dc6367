// A progress bar on stderr for work that takes longer than two seconds.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace vdna::program
{

// One piece of work of known length:
//     Progress bar("building winter", frames.size());
//     for (...) { ...; bar.advance(); }
// Silent unless stderr is a terminal and two seconds have passed; the destructor ends the line.
class Progress
{
  public:
    Progress(const std::string &title, size_t total);
    ~Progress();
    Progress(const Progress &) = delete;
    Progress &operator=(const Progress &) = delete;

    void advance(size_t steps = 1);

  private:
    using Clock = std::chrono::steady_clock;
    void draw(Clock::time_point now);

    std::string title_;
    size_t total_;
    size_t done_ = 0;
    bool visible_;
    bool drawn_ = false;
    Clock::time_point begin_;
    Clock::time_point due_; // earliest time to draw the line again
};

// The text of the bar, without a line end: "winter [#####---------------]  30/120  15/s  6 s left".
std::string progress_line(const std::string &title, size_t done, size_t total, double elapsed_s);

} // namespace vdna::program
