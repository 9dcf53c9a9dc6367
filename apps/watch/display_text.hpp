// Texts of unknown origin in the cells of a terminal. A wide character, as in CJK names, takes two.
#pragma once

#include <string>
#include <vector>

namespace vdna::watch
{

// The text with '?' for whatever is no character to be shown, so that nothing in it controls the
// terminal: control characters, those that turn the direction of writing, invalid UTF-8.
std::string printable(const std::string &text);

// Cells that a printable text takes.
int width_of(const std::string &text);

// The first characters of a printable text that fit into `cells`.
std::string first(const std::string &text, int cells);

// A printable text in at most `cells`; what is cut off leaves "…".
std::string cut(const std::string &text, int cells);

// A printable text in lines of at most `cells`, broken between words; longer words are cut.
std::vector<std::string> wrapped(const std::string &text, int cells);

// A printable text in ASCII, as wide: our own marks by others, and '?' for every other character.
std::string in_ascii(const std::string &text);

} // namespace vdna::watch
