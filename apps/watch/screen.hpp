// The live terminal's screen: what is shown of a daemon, in lines that fit the window. How a
// terminal draws them is terminal.hpp's.
#pragma once

#include <string>
#include <vector>

#include "telemetry/newest.hpp"

namespace vdna::watch
{

// What a text is; a terminal may make colours of it, which say nothing that the text does not.
enum class Tone { plain, strong, faint, good, wait, doubt, bad };

struct Span {
    std::string text; // printable
    Tone tone;
};

using Line = std::vector<Span>;

struct Size {
    int columns, rows;
};

// Cells that a line takes.
int width_of(const Line &line);

// At most `size.rows` lines of at most `size.columns` cells, the same for the same arguments. Made
// for 80 x 24; in a smaller window what matters less is left out.
// url: of the network; now_us: monotonic, as in `newest`
std::vector<Line> screen(const telemetry::Newest &newest, const std::string &url, int64_t now_us,
                         Size size);

} // namespace vdna::watch
