// What is heard on the daemon's network.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <vdna/transport.h>

#include "doctor/settings.hpp"
#include "program/print.hpp"

namespace vdna::doctor
{

// One camera frame.
struct Stamp {
    int64_t utime;   // as the camera gave it
    int64_t wall_us; // when it came, microseconds since 1970
};

struct Heard {
    std::string refusal; // why the network cannot be heard; "" = it can
    bool is_log = false; // the URL names a log: nothing is to be heard
    double seconds = 0;
    vdna_transport_counters counters{};
    std::vector<vdna_transport_overheard> others; // all channels but the camera's
    std::vector<Stamp> stamps;                    // in the order in which they came
    uint64_t picture_bytes = 0;                   // of the newest frame
    program::Json status; // the daemon's newest, as telemetry has it; null = none
};

// Listen for some seconds. Throws Error on Ctrl-C.
Heard listen(const Settings &settings, double seconds);

} // namespace vdna::doctor
