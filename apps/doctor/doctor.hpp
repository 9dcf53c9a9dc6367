// All checks of a robot, in the order in which they are shown. Nothing is changed on the machine.
#pragma once

#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "doctor/settings.hpp"
#include "program/print.hpp"

namespace vdna::doctor
{

struct Diagnosis {
    Settings settings;
    std::vector<Check> checks;
};

// seconds: to listen; root: of /proc, /sys and /etc. Throws Error on Ctrl-C.
Diagnosis examine(const Named &named, double seconds, const std::filesystem::path &root);

// The report has been written, and a check fails.
struct Unwell : std::exception {
};

bool has_failed(const Diagnosis &diagnosis);

// For people: lines of 80 columns, unless a word is longer.
std::string screen_of(const Diagnosis &diagnosis);

program::Json json_of(const Diagnosis &diagnosis);

} // namespace vdna::doctor
