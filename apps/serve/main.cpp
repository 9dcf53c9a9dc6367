// vdna_serve - shows a running vdna_selectord in a browser. A program of its own, run by `vdna
// serve`: so it needs neither a network nor OpenCV, and ends nothing if it ends.
#include <cstdio>
#include <iostream>
#include <optional>
#include <random>

#include <malloc.h>

#include <vdna/cpp/connection.hpp>

#include "program/exit_code.hpp"
#include "program/interrupt.hpp"
#include "serve/command_line.hpp"
#include "serve/page_server.hpp"
#include "serve/reception.hpp"

namespace vdna::serve
{

namespace
{

void check(const Options &options)
{
    if (vdna_transport_is_log(options.channels.url.c_str()))
        throw program::UsageError(options.channels.url +
                                  ": a log ends; send it by lcm-logplayer and listen to that");
    vdna_error error{};
    require(vdna_transport_check_channel(options.command_channel.c_str(), &error), error);
}

// 128 random bits in hexadecimal.
std::string new_token()
{
    std::random_device random;
    std::string token;
    for (int i = 0; i < 4; i++) {
        char digits[9];
        std::snprintf(digits, sizeof digits, "%08x", random());
        token += digits;
    }
    return token;
}

// The page's address, with the token where a browser does not send it.
std::string url_of(const Options &options, int port, const std::string &token)
{
    const bool any = options.address == "0.0.0.0" || options.address == "::";
    const bool v6 = !any && options.address.find(':') != std::string::npos;
    const std::string host = any ? "127.0.0.1" : v6 ? "[" + options.address + "]" : options.address;
    return "http://" + host + ":" + std::to_string(port) + "/#" + token;
}

void serve(const Options &options)
{
    check(options);
    std::optional<MapPictures> pictures;
    if (!options.map.empty())
        pictures.emplace(options.map);
    LiveState state;
    Reception reception(options.channels, state);
    const Connection commands = connect_to_send(options.channels.url);
    const std::string token = new_token();
    const PageServer server({options.address, options.port, token,
                             [&](const telemetry::Command &command, const std::string &argument) {
                                 telemetry::send_command(commands, options.command_channel, command,
                                                         argument);
                                 std::cerr << "vdna serve: sent " << command.name << std::endl;
                             },
                             pictures ? &*pictures : nullptr},
                            state);
    std::cerr << "vdna serve: listening; whoever has this address, token included, may press the "
                 "page's buttons:"
              << std::endl;
    std::cout << url_of(options, server.port(), token) << std::endl;
    while (!program::interrupted() && !server.has_ended())
        reception.run_once(server.viewers());
    if (server.has_ended())
        throw Error(
            "the page can no longer be served: the system refuses connections; start again");
}

int fail(const std::string &sentence, int code)
{
    std::cerr << "vdna serve: " << sentence << '\n';
    return code;
}

} // namespace

} // namespace vdna::serve

int main(int argc, char **argv)
{
    // Threads that share their heaps: half the memory.
    mallopt(M_ARENA_MAX, 1);
    vdna::program::catch_interrupts();
    try {
        if (const auto options = vdna::serve::read_command_line(argc, argv))
            vdna::serve::serve(*options);
        return vdna::program::exit_ok;
    } catch (const vdna::Error &e) {
        return vdna::serve::fail(e.what(), vdna::program::exit_code_of(e));
    } catch (const std::exception &e) {
        return vdna::serve::fail(e.what(), vdna::program::exit_failed);
    }
}
