#include "doctor/network.hpp"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include <arpa/inet.h>
#include <net/if.h>

#include "doctor/system_files.hpp"
#include "telemetry/type_name.hpp"

namespace vdna::doctor
{

namespace
{

std::vector<Route> read_routes(const std::filesystem::path &root)
{
    std::vector<Route> routes;
    std::istringstream lines(read_text(root / "proc/net/route").value_or(""));
    std::string line;
    for (std::getline(lines, line); std::getline(lines, line);) { // below the head
        std::istringstream cells(line);
        Route route;
        unsigned gateway = 0, flags = 0, count = 0, use = 0;
        cells >> route.interface >> std::hex >> route.destination >> gateway >> flags >> std::dec >>
            count >> use >> route.metric >> std::hex >> route.mask;
        if (cells)
            routes.push_back(route);
    }
    return routes;
}

std::map<std::string, unsigned> read_interfaces(const std::filesystem::path &root)
{
    std::map<std::string, unsigned> flags;
    std::error_code none;
    for (const auto &entry : std::filesystem::directory_iterator(root / "sys/class/net", none))
        flags[entry.path().filename()] = static_cast<unsigned>(
            std::strtoul(read_line(entry.path() / "flags").c_str(), nullptr, 16));
    return flags;
}

// The one that a datagram to the group takes: the narrowest, of these that of the lowest metric.
const Route *route_to(const NetworkFacts &network)
{
    const Route *best = nullptr;
    for (const Route &route : network.routes) {
        const uint32_t mask = ntohl(route.mask);
        const bool is_better = !best || mask > ntohl(best->mask) ||
                               (mask == ntohl(best->mask) && route.metric < best->metric);
        if ((network.udpm->group & route.mask) == route.destination && is_better)
            best = &route;
    }
    return best;
}

std::string address_text(uint32_t address)
{
    std::array<char, INET_ADDRSTRLEN> text{};
    inet_ntop(AF_INET, &address, text.data(), text.size());
    return text.data();
}

// An interface by which other machines can be reached; "eth0" if there is none.
std::string outward(const NetworkFacts &network)
{
    for (const auto &[name, flags] : network.interfaces)
        if (!(flags & IFF_LOOPBACK) && (flags & IFF_UP) && (flags & IFF_MULTICAST))
            return name;
    return "eth0";
}

std::string rate_text(uint64_t messages, double seconds)
{
    const double hz = static_cast<double>(messages) / seconds;
    return program::fixed(hz, hz < 9.95 ? 1 : 0) + " Hz";
}

constexpr const char *not_udpm = "not by multicast: the URL names no udpm:// network";

} // namespace

NetworkFacts read_network(const std::filesystem::path &root, const std::string &url)
{
    NetworkFacts network;
    vdna_udpm udpm{};
    if (vdna_udpm_read(url.c_str(), &udpm))
        network.udpm = udpm;
    network.routes = read_routes(root);
    network.interfaces = read_interfaces(root);
    network.buffer_max = number_in(read_line(root / "proc/sys/net/core/rmem_max"));
    return network;
}

Verdict check_route(const NetworkFacts &network)
{
    if (!network.udpm)
        return unknown(not_udpm);
    const std::string group = address_text(network.udpm->group);
    const Route *route = route_to(network);
    if (!route)
        return broken("no route to " + group,
                      network.udpm->ttl > 0
                          ? "sudo ip route add " + group + " dev " + outward(network)
                          : "sudo ip link set lo up && sudo ip route add 224.0.0.0/4 dev lo");
    const auto found = network.interfaces.find(route->interface);
    const unsigned flags = found == network.interfaces.end() ? 0 : found->second;
    if (!(flags & IFF_UP))
        return broken(group + " goes by " + route->interface + ", which is down",
                      "sudo ip link set " + route->interface + " up");
    const bool is_loopback = flags & IFF_LOOPBACK;
    if (is_loopback && network.udpm->ttl > 0)
        return warn("ttl is " + std::to_string(network.udpm->ttl) + ", but " + group + " goes by " +
                        route->interface + ", which reaches no other machine",
                    "sudo ip route replace " + group + " dev " + outward(network));
    if (!is_loopback && !(flags & IFF_MULTICAST))
        return broken(group + " goes by " + route->interface + ", which has no multicast",
                      "sudo ip link set " + route->interface + " multicast on");
    return ok(group + " goes by " + route->interface);
}

Verdict check_buffer(const NetworkFacts &network)
{
    if (!network.udpm)
        return unknown(not_udpm);
    if (!network.buffer_max)
        return unknown("the system does not tell net.core.rmem_max");
    const auto wanted = static_cast<uint64_t>(network.udpm->buffer_bytes);
    if (*network.buffer_max >= wanted)
        return ok(bytes_text(wanted) + " to receive into");
    return warn(bytes_text(*network.buffer_max) + " to receive into, " + bytes_text(wanted) +
                    " are wanted: large pictures will be lost",
                "sudo sysctl -w net.core.rmem_max=" + std::to_string(wanted) +
                    "; to keep it, a file in /etc/sysctl.d");
}

Verdict check_ttl(const NetworkFacts &network, const Settings &settings, const Heard &heard)
{
    if (!network.udpm)
        return unknown(not_udpm);
    const bool stays = network.udpm->ttl <= 0;
    if (const uint64_t ignored = heard.counters.foreign_datagrams; ignored > 0)
        return warn(
            "datagrams of other machines were ignored: " + std::to_string(ignored),
            (stays ? "to hear them, set ttl=1 in url " : "add their addresses to sources ") +
                section_of("lcm", settings));
    if (stays && settings.sources.empty())
        return ok("0: only programs of this machine are heard, and hear");
    if (stays)
        return ok("0: only this machine hears; " + std::to_string(settings.sources.size()) +
                  " others are heard");
    const std::string reach = std::to_string(network.udpm->ttl) + ": other machines hear, and ";
    return ok(reach + (settings.sources.empty()
                           ? "every machine is heard ([lcm] sources)"
                           : std::to_string(settings.sources.size()) + " of them are heard"));
}

Verdict check_channels(const Settings &settings, const Heard &heard)
{
    constexpr size_t named_max = 4;
    if (heard.is_log)
        return unknown("the URL names a log: nothing is to be heard");
    if (!heard.refusal.empty())
        return failed(heard.refusal);
    std::string list;
    const uint64_t camera = heard.counters.received + heard.counters.camera_rejected;
    if (camera > 0)
        list = settings.camera + " " + rate_text(camera, heard.seconds);
    for (size_t i = 0; i < std::min(heard.others.size(), named_max); i++)
        list += (list.empty() ? "" : ", ") + text_of(heard.others[i]);
    if (heard.others.size() > named_max)
        list += " and " + std::to_string(heard.others.size() - named_max) + " more";
    if (list.empty())
        return warn("nothing in " + program::fixed(heard.seconds, 1) + " s on " + settings.url,
                    "start the programs that send, all on this URL: url " +
                        section_of("lcm", settings));
    return ok(list);
}

std::string printable(std::string name)
{
    for (char &c : name)
        if ((c >= 0 && c < ' ') || c == 0x7f)
            c = '?';
    return name;
}

std::string text_of(const vdna_transport_overheard &channel)
{
    const char *type = telemetry::type_name(channel.fingerprint);
    char number[40];
    std::snprintf(number, sizeof number, "of type %016" PRIx64, channel.fingerprint);
    const int64_t span_us = channel.last_us - channel.first_us;
    return printable(channel.channel) + " " + (type ? type : number) +
           (span_us > 0 ? " " + rate_text(channel.messages - 1, static_cast<double>(span_us) / 1e6)
                        : "");
}

std::string section_of(const std::string &section, const Settings &settings)
{
    return "in [" + section + "] of " +
           (settings.file.empty() ? "the settings (-c)" : settings.file);
}

} // namespace vdna::doctor
