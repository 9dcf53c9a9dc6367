#include "watch/terminal.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <vdna/cpp/error.hpp>

#include "watch/display_text.hpp"

namespace vdna::watch
{

namespace
{

// Another page, no cursor, no wrapping; and back.
constexpr std::string_view enter = "\033[?1049h\033[?25l\033[?7l";
constexpr std::string_view leave = "\033[0m\033[?7h\033[?25h\033[?1049l";

// These end the program at once, so their handler restores the terminal; SIGINT and SIGTERM end it
// in order.
constexpr std::array<int, 6> fatal{SIGHUP, SIGQUIT, SIGABRT, SIGSEGV, SIGBUS, SIGFPE};

termios keyboard;          // as it was
bool has_keyboard = false; // standard input is a terminal
volatile std::sig_atomic_t must_redraw = 0;

// May be called from a handler of signals.
void restore()
{
    if (has_keyboard)
        tcsetattr(STDIN_FILENO, TCSANOW, &keyboard);
    (void)!write(STDOUT_FILENO, leave.data(), leave.size());
}

extern "C" void restore_and_end(int number)
{
    restore();
    raise(number); // its default is set again
}

extern "C" void note_change(int)
{
    must_redraw = 1;
}

void handle(int number, void (*handler)(int), int flags)
{
    struct sigaction action = {};
    action.sa_handler = handler;
    action.sa_flags = flags;
    sigemptyset(&action.sa_mask);
    sigaction(number, &action, nullptr);
}

void handle_signals(void (*on_fatal)(int), void (*on_change)(int))
{
    for (const int number : fatal)
        handle(number, on_fatal, static_cast<int>(SA_RESETHAND));
    handle(SIGWINCH, on_change, 0);
    handle(SIGCONT, on_change, 0);
}

// Keys come one by one, unseen, and without waiting. Ctrl-C still interrupts; Ctrl-Z and Ctrl-\ do
// nothing, because the shell would get the terminal as it is.
void take_keyboard()
{
    termios ours = keyboard;
    ours.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    ours.c_cc[VMIN] = ours.c_cc[VTIME] = 0;
    ours.c_cc[VSUSP] = ours.c_cc[VQUIT] = _POSIX_VDISABLE;
    tcsetattr(STDIN_FILENO, TCSANOW, &ours);
}

void put(std::string_view bytes)
{
    while (!bytes.empty()) {
        const ssize_t written = write(STDOUT_FILENO, bytes.data(), bytes.size());
        if (written < 0 && errno != EINTR)
            throw Error(std::string("the terminal cannot be written to: ") + std::strerror(errno));
        bytes.remove_prefix(written > 0 ? static_cast<size_t>(written) : 0);
    }
}

void take_over()
{
    if (has_keyboard)
        take_keyboard();
    put(enter);
}

// The first of them that is set and not empty; "" if none is.
std::string first_set(std::initializer_list<const char *> names)
{
    for (const char *const name : names)
        if (const char *const value = std::getenv(name); value && *value)
            return value;
    return "";
}

bool speaks_utf8()
{
    std::string locale = first_set({"LC_ALL", "LC_CTYPE", "LANG"});
    std::transform(locale.begin(), locale.end(), locale.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    return locale.find("utf-8") != std::string::npos || locale.find("utf8") != std::string::npos;
}

const char *colour_of(Tone tone)
{
    switch (tone) {
    case Tone::strong:
        return "\033[1m";
    case Tone::faint:
        return "\033[2m";
    case Tone::good:
        return "\033[32m";
    case Tone::wait:
        return "\033[36m";
    case Tone::doubt:
        return "\033[33m";
    case Tone::bad:
        return "\033[1;31m";
    default:
        return "";
    }
}

std::string painted(const Line &line, bool has_colours, bool has_utf8)
{
    std::string painted;
    for (const Span &span : line) {
        const std::string text = has_utf8 ? span.text : in_ascii(span.text);
        const char *const colour = has_colours ? colour_of(span.tone) : "";
        painted += colour + text + (*colour ? "\033[0m" : "");
    }
    return painted;
}

} // namespace

bool has_terminal()
{
    const std::string kind = first_set({"TERM"});
    return isatty(STDOUT_FILENO) && !kind.empty() && kind != "dumb";
}

Terminal::Terminal() : has_colours_(first_set({"NO_COLOR"}).empty()), has_utf8_(speaks_utf8())
{
    has_keyboard = tcgetattr(STDIN_FILENO, &keyboard) == 0;
    handle_signals(restore_and_end, note_change);
    take_over();
}

Terminal::~Terminal()
{
    restore();
    handle_signals(SIG_DFL, SIG_DFL);
}

Size Terminal::size() const
{
    winsize window = {};
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) != 0 || window.ws_col == 0 || window.ws_row == 0)
        return {80, 24};
    return {window.ws_col, window.ws_row};
}

bool Terminal::is_left()
{
    char key = 0;
    while (has_keyboard && !is_left_ && read(STDIN_FILENO, &key, 1) == 1)
        is_left_ = key == 'q' || key == 'Q';
    return is_left_;
}

void Terminal::show(const std::vector<Line> &lines)
{
    std::string bytes;
    if (must_redraw) { // also after a stop, during which the shell had the terminal
        must_redraw = 0;
        take_over();
        bytes = "\033[2J";
        shown_.clear();
    }
    shown_.resize(std::max(shown_.size(), lines.size()));
    for (size_t i = 0; i < shown_.size(); i++) {
        const std::string line = i < lines.size() ? painted(lines[i], has_colours_, has_utf8_) : "";
        if (line != shown_[i])
            bytes += "\033[" + std::to_string(i + 1) + ";1H\033[K" + line;
        shown_[i] = line;
    }
    put(bytes);
}

} // namespace vdna::watch
