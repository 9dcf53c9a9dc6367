#include "program/progress.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <unistd.h>

namespace vdna::program
{

namespace
{

constexpr std::chrono::seconds patience(2);          // shorter work needs no bar
constexpr std::chrono::milliseconds redraw_gap(100); // ten a second look smooth

std::string time_left(double seconds)
{
    const auto whole = static_cast<long>(std::ceil(seconds));
    char text[32];
    if (whole < 60)
        std::snprintf(text, sizeof text, "%ld s left", whole);
    else
        std::snprintf(text, sizeof text, "%ld:%02ld min left", whole / 60, whole % 60);
    return text;
}

} // namespace

std::string progress_line(const std::string &title, size_t done, size_t total, double elapsed_s)
{
    constexpr size_t width = 20;
    done = std::min(done, total);
    const size_t filled = total > 0 ? width * done / total : width;
    const std::string bar = std::string(filled, '#') + std::string(width - filled, '-');
    std::string line =
        title + " [" + bar + "]  " + std::to_string(done) + "/" + std::to_string(total);
    if (done == 0 || elapsed_s <= 0)
        return line;

    const double rate = static_cast<double>(done) / elapsed_s;
    char text[32];
    std::snprintf(text, sizeof text, rate < 10 ? "  %.1f/s  " : "  %.0f/s  ", rate);
    return line + text + time_left(static_cast<double>(total - done) / rate);
}

Progress::Progress(const std::string &title, size_t total)
    : title_(title), total_(total), visible_(isatty(STDERR_FILENO) == 1), begin_(Clock::now()),
      due_(begin_ + patience)
{
}

Progress::~Progress()
{
    if (!drawn_)
        return;
    draw(Clock::now());
    std::fputc('\n', stderr);
}

void Progress::advance(size_t steps)
{
    done_ += steps;
    const auto now = Clock::now();
    if (visible_ && now >= due_)
        draw(now);
}

void Progress::draw(Clock::time_point now)
{
    const std::chrono::duration<double> elapsed = now - begin_;
    // The escape sequence clears the rest of a longer previous line.
    std::fprintf(stderr, "\r%s\x1b[K",
                 progress_line(title_, done_, total_, elapsed.count()).c_str());
    std::fflush(stderr);
    drawn_ = true;
    due_ = now + redraw_gap;
}

} // namespace vdna::program
