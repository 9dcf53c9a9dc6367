// The way of messages: route, buffer, who may send, which channels there are.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "doctor/hearing.hpp"
#include "transport/udpm.h"

namespace vdna::doctor
{

// An entry of the system's table; addresses in network order.
struct Route {
    std::string interface;
    uint32_t destination, mask, metric;
};

struct NetworkFacts {
    std::optional<vdna_udpm> udpm; // nothing: another kind of network
    std::vector<Route> routes;
    std::map<std::string, unsigned> interfaces; // flags of each, as IFF_UP
    std::optional<uint64_t> buffer_max;         // net.core.rmem_max; nothing: not known
};

NetworkFacts read_network(const std::filesystem::path &root, const std::string &url);

Verdict check_route(const NetworkFacts &network);
Verdict check_buffer(const NetworkFacts &network);
Verdict check_ttl(const NetworkFacts &network, const Settings &settings, const Heard &heard);
Verdict check_channels(const Settings &settings, const Heard &heard);

// Without control characters, which must not reach a terminal: anybody may name a channel.
std::string printable(std::string name);

// "POSE bot_core.pose_t 100 Hz"
std::string text_of(const vdna_transport_overheard &channel);

// "in [lcm] of /etc/vdna/vdna.toml"
std::string section_of(const std::string &section, const Settings &settings);

} // namespace vdna::doctor
