// The map, its network, and the daemon that serves it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "doctor/hearing.hpp"

namespace vdna::doctor
{

struct MapFacts {
    std::string refusal;               // why the map cannot be opened; "" = it is open
    std::vector<std::string> left_out; // why each damaged experience is
    size_t experiences = 0;
    uint64_t frames = 0;
    uint64_t largest_bytes = 0; // of its experience files
    std::string hash;
    std::string network_refusal; // why the network cannot be opened; "" = it is open
    std::string mismatch;        // why the network is not the map's; "" = it is, or one is not open
    std::string network, sha256, precision, runtime; // of the network
    std::string trust;                               // what the map knows about itself, a sentence
    std::string no_prediction; // why it predicts no recall, and what to do; "" = it does
};

// Open the map and the network. Throws nothing that is about them.
MapFacts examine_map(const Settings &settings);

Verdict check_files(const Settings &settings, const MapFacts &map);
Verdict check_network(const MapFacts &map);
Verdict check_trust(const MapFacts &map);

// own, host: our version, the name of this machine
Verdict check_daemon(const Settings &settings, const MapFacts &map, const Heard &heard,
                     const std::string &own, const std::string &host);

} // namespace vdna::doctor
