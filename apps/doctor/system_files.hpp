// Small files of the system, below a root that tests replace.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>

namespace vdna::doctor
{

// All of a file of /proc, /sys or /etc; nothing if it cannot be read.
std::optional<std::string> read_text(const std::filesystem::path &file);

// Its one line, without the end; "" if it cannot be read.
std::string read_line(const std::filesystem::path &file);

// A whole number at the beginning of a text; nothing if there is none.
std::optional<uint64_t> number_in(const std::string &text);

// What follows NAME and blanks, a colon or an equals sign at the beginning of a line of a text: "12
// kB" of "MemFree:   12 kB"; "" if no line has it.
std::string value_of(const std::string &text, const std::string &name);

// The numbers of a list as taskset has it, "0,2-3"; nothing if it is none.
std::optional<std::set<unsigned>> numbers_of_list(const std::string &list);

// "3.4 GiB", "640 KiB"
std::string bytes_text(uint64_t bytes);

} // namespace vdna::doctor
