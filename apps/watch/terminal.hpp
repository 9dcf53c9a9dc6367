// A screen on the terminal: its own page, without a cursor and without wrapping, restored at the
// end, whatever ends the program.
#pragma once

#include <string>
#include <vector>

#include "watch/screen.hpp"

namespace vdna::watch
{

// Whether standard output is a terminal that can show a screen.
bool has_terminal();

// One at a time.
class Terminal
{
  public:
    // Take the terminal over. Throws Error if it is gone.
    Terminal();
    ~Terminal();
    Terminal(const Terminal &) = delete;
    Terminal &operator=(const Terminal &) = delete;

    // Of the window, now.
    Size size() const;
    // Whether somebody has pressed q.
    bool is_left();
    // Draw what differs from the last screen, and everything after a change of the window. Throws
    // Error if the terminal is gone.
    void show(const std::vector<Line> &lines);

  private:
    const bool has_colours_, has_utf8_;
    bool is_left_ = false;
    std::vector<std::string> shown_;
};

} // namespace vdna::watch
