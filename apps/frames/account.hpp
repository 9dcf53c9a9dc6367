// What was read of a source, and what was left out.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "program/print.hpp"

namespace vdna::frames
{

struct Account {
    std::string order;              // what orders the frames: "utime", "numbers" or "names" of
                                    // pictures, "log", "video", or "manifest"
    std::string time_unit;          // of the stamps found: "microseconds" ...; "" = there are none
    uint64_t expected = 0;          // frames that the source should have; 0 = it does not say
    uint64_t bad = 0;               // frames that are unusable or missing
    uint64_t late = 0;              // frames older than one before them
    std::string first_bad;          // why the first of the bad frames is one; "" if there is none
    std::vector<std::string> notes; // sentences about the source, without its name
};

// The notes, and what was left out; empty if there is nothing to tell.
std::vector<std::string> sentences_of(const Account &account);

// The members that reports of all sub-commands have: "order", "time_unit",
// "expected_frames" (null if the source does not say), "bad_frames",
// "late_frames" and "notes".
program::Json json_of(const Account &account);

} // namespace vdna::frames
