// The doctor's checks of the network, each broken on purpose.
#include <cstring>

#include "doctor/network.hpp"
#include "system_root.hpp"
#include "verdicts.hpp"

using namespace vdna::doctor;

namespace
{

constexpr const char *url = "udpm://239.255.76.67:7667?ttl=0";
constexpr const char *far_url = "udpm://239.255.76.67:7667?ttl=1";
constexpr const char *head =
    "Iface\tDestination\tGateway\tFlags\tRefCnt\tUse\tMetric\tMask\tMTU\tWindow\tIRTT\n";
constexpr const char *by_lo = "lo\t000000E0\t00000000\t0001\t0\t0\t0\t000000F0\t0\t0\t0\n";
constexpr const char *by_eth0 = "eth0\t00000000\t0101A8C0\t0003\t0\t0\t100\t00000000\t0\t0\t0\n";

// A machine with lo, eth0 (192.168.1.x) and these routes.
NetworkFacts with_routes(const std::string &routes, const char *of = url,
                         const char *eth0 = "0x1003")
{
    SystemRoot root;
    root.write("proc/net/route", head + routes);
    root.write("sys/class/net/lo/flags", "0x9\n");
    root.write("sys/class/net/eth0/flags", std::string(eth0) + "\n");
    root.write("proc/sys/net/core/rmem_max", "8388608\n");
    return read_network(root.path(), of);
}

vdna_transport_overheard channel(const char *name, uint64_t fingerprint)
{
    vdna_transport_overheard overheard{};
    std::strcpy(overheard.channel, name);
    overheard.fingerprint = fingerprint;
    overheard.messages = 31;
    overheard.last_us = 3000000;
    return overheard;
}

Heard seconds(double count)
{
    Heard heard;
    heard.seconds = count;
    return heard;
}

void a_route_is_named_by_its_interface(void **)
{
    expect_ok(check_route(with_routes(by_lo)), "239.255.76.67 goes by lo");
    expect_ok(check_route(with_routes(by_eth0)), "goes by eth0");
    // The narrower one counts.
    expect_ok(check_route(with_routes(std::string(by_eth0) + by_lo)), "goes by lo");
    expect_unknown(check_route(with_routes("", "memq://")), "no udpm:// network");
}

void a_missing_route_fails(void **)
{
    expect_failure(check_route(with_routes("")), "no route to 239.255.76.67",
                   "ip route add 224.0.0.0/4 dev lo");
    expect_failure(check_route(with_routes("", far_url)), "no route",
                   "ip route add 239.255.76.67 dev eth0");
}

void a_route_that_leads_nowhere_fails(void **)
{
    expect_failure(check_route(with_routes(by_eth0, url, "0x1002")), "eth0, which is down",
                   "ip link set eth0 up");
    expect_failure(check_route(with_routes(by_eth0, url, "0x3")), "no multicast",
                   "ip link set eth0 multicast on");
    expect_warning(check_route(with_routes(by_lo, far_url)), "reaches no other machine",
                   "ip route replace 239.255.76.67 dev eth0");
}

void a_small_receive_buffer_is_a_warning(void **)
{
    NetworkFacts network = with_routes(by_lo);
    expect_ok(check_buffer(network), "4.0 MiB");
    network.buffer_max = 212992;
    expect_warning(check_buffer(network), "208 KiB to receive into, 4.0 MiB are wanted",
                   "sysctl -w net.core.rmem_max=4194304");
    network.buffer_max.reset();
    expect_unknown(check_buffer(network), "rmem_max");
}

void datagrams_of_other_machines_that_are_ignored_are_a_warning(void **)
{
    Settings settings;
    Heard heard = seconds(3);
    expect_ok(check_ttl(with_routes(by_lo), settings, heard), "0: only programs of this machine");
    expect_ok(check_ttl(with_routes(by_eth0, far_url), settings, heard), "every machine is heard");
    heard.counters.foreign_datagrams = 7;
    expect_warning(check_ttl(with_routes(by_lo), settings, heard), "ignored: 7",
                   "set ttl=1 in url");
    settings.sources = {"10.0.0.2"};
    expect_warning(check_ttl(with_routes(by_eth0, far_url), settings, heard), "ignored: 7",
                   "sources");
}

void a_silent_network_is_a_warning_and_a_closed_one_a_failure(void **)
{
    Settings settings;
    settings.url = url;
    Heard heard = seconds(3);
    expect_warning(check_channels(settings, heard), "nothing in 3.0 s",
                   "start the programs that send");
    heard.others = {channel("CAMERA_FRONT", 0x14739ffe13d5f5f0), channel("A\033[2J", 5)};
    heard.counters.received = 45;
    expect_ok(check_channels(settings, heard), "CAMERA 15 Hz, CAMERA_FRONT bot_core.image_t 10 Hz, "
                                               "A?[2J of type 0000000000000005 10 Hz");
    heard.refusal = "udpm://...: cannot receive from this network: no device; add a route";
    expect_failure(check_channels(settings, heard), "no device", "add a route");
    heard.is_log = true;
    expect_unknown(check_channels(settings, heard), "a log");
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_route_is_named_by_its_interface),
        cmocka_unit_test(a_missing_route_fails),
        cmocka_unit_test(a_route_that_leads_nowhere_fails),
        cmocka_unit_test(a_small_receive_buffer_is_a_warning),
        cmocka_unit_test(datagrams_of_other_machines_that_are_ignored_are_a_warning),
        cmocka_unit_test(a_silent_network_is_a_warning_and_a_closed_one_a_failure),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
