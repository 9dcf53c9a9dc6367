// vdna_serve - shows a running vdna_selectord in a browser. A program of its own, run by `vdna
// serve`: so it needs neither a network nor OpenCV, and ends nothing if it ends.
#include <cstdio>
#include <iostream>
#include <optional>
#include <random>

#include <CLI/CLI.hpp>
#include <malloc.h>

#include <vdna/version.h>

#include "program/exit_code.hpp"
#include "program/interrupt.hpp"
#include "serve/page_server.hpp"
#include "serve/reception.hpp"

namespace vdna::serve
{

namespace
{

struct Options {
    Channels channels;
    std::string command_channel = VDNA_CHANNEL_COMMAND;
    std::string address = "127.0.0.1";
    int port = 8070;
    std::string map; // directory; "" = none
};

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

Connection connect_for_commands(const std::string &url)
{
    vdna_transport_config config;
    vdna_transport_config_init(&config);
    config.url = url.empty() ? nullptr : url.c_str();
    return connect(config);
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
    const Connection commands = connect_for_commands(options.channels.url);
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

void add_options(CLI::App &app, Options &options)
{
    app.add_option("-l,--lcm-url", options.channels.url,
                   "LCM network; default: $LCM_DEFAULT_URL, else LCM's")
        ->type_name("URL");
    app.add_option("--address", options.address,
                   "address of this machine to listen on; 0.0.0.0 = all of them, for whoever is in "
                   "the network to look, unencrypted")
        ->capture_default_str();
    app.add_option("--port", options.port, "TCP port; 0 = any free one")
        ->check(CLI::Range(0, 65535))
        ->capture_default_str();
    app.add_option("--map", options.map,
                   "map of the daemon, to show its matched frame beside the camera's picture")
        ->type_name("DIR");
    options.channels.camera = VDNA_CHANNEL_CAMERA;
    app.add_option("--camera", options.channels.camera, "channel")->capture_default_str();
    for (const telemetry::View &view : telemetry::views())
        options.channels.views.push_back(view.channel);
    for (size_t i = 0; i < options.channels.views.size(); i++)
        app.add_option(std::string("--") + telemetry::views()[i].name, options.channels.views[i],
                       "channel")
            ->capture_default_str();
    app.add_option("--command", options.command_channel, "channel")->capture_default_str();
}

int fail(const std::string &sentence, int code)
{
    std::cerr << "vdna serve: " << sentence << '\n';
    return code;
}

} // namespace

} // namespace vdna::serve

// NOLINTNEXTLINE(bugprone-exception-escape): only of options that clash
int main(int argc, char **argv)
{
    // Threads that share their heaps: half the memory.
    mallopt(M_ARENA_MAX, 1);
    vdna::program::catch_interrupts();
    CLI::App app(
        "Show a running vdna_selectord in a browser: what the camera sees, which experience "
        "is chosen and why, how sure the places are, and what is wrong. Nothing comes "
        "from another machine. Ends with Ctrl-C.",
        "vdna serve");
    app.set_version_flag("--version", std::string("vdna_serve ") + vdna_version());
    app.footer("Example:\n  vdna serve --port 8070\nFrom another machine, through ssh:\n  "
               "ssh -L 8070:127.0.0.1:8070 ROBOT vdna serve");
    vdna::serve::Options options;
    vdna::serve::add_options(app, options);
    try {
        app.parse(argc, argv);
        vdna::serve::serve(options);
        return vdna::program::exit_ok;
    } catch (const CLI::Success &request) {
        return app.exit(request);
    } catch (const CLI::ParseError &e) {
        return vdna::serve::fail(std::string(e.what()) + "; see vdna serve --help",
                                 vdna::program::exit_usage);
    } catch (const vdna::Error &e) {
        return vdna::serve::fail(e.what(), vdna::program::exit_code_of(e));
    } catch (const std::exception &e) {
        return vdna::serve::fail(e.what(), vdna::program::exit_failed);
    }
}
