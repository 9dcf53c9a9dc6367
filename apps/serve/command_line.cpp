#include "serve/command_line.hpp"

#include <CLI/CLI.hpp>

#include <vdna/version.h>

#include "program/exit_code.hpp"

namespace vdna::serve
{

namespace
{

const char *const about =
    "Show a running vdna_selectord in a browser: what the camera sees, which experience is chosen "
    "and why, how sure the places are, and what is wrong";

void describe(CLI::App &app, Options &options)
{
    usage::add_standard_options(app, std::string("vdna_serve ") + vdna_version());
    app.add_option("-l,--lcm-url", options.channels.url,
                   "LCM network (default: $LCM_DEFAULT_URL, else LCM's)")
        ->type_name("URL");
    app.add_option("--address", options.address,
                   "address of this machine to listen on; 0.0.0.0 = all of them, for whoever is in "
                   "the network to look, unencrypted")
        ->type_name("ADDRESS")
        ->capture_default_str();
    app.add_option("--port", options.port, "TCP port; 0 = any free one")
        ->check(CLI::Range(0, 65535).description(""))
        ->type_name("0..65535")
        ->capture_default_str();
    app.add_option("--map", options.map,
                   "map of the daemon, to show its matched frame beside the camera's picture")
        ->type_name("DIR");
    const auto add_channel = [&](const std::string &name, std::string &channel) {
        app.add_option("--" + name, channel, "channel of that name")
            ->type_name("CHANNEL")
            ->capture_default_str();
    };
    options.channels.camera = VDNA_CHANNEL_CAMERA;
    add_channel("camera", options.channels.camera);
    for (const telemetry::View &view : telemetry::views())
        options.channels.views.push_back(view.channel);
    for (size_t i = 0; i < options.channels.views.size(); i++)
        add_channel(telemetry::views()[i].name, options.channels.views[i]);
    add_channel("command", options.command_channel);
    app.footer("Nothing comes from another machine. Ends with Ctrl-C. From another machine, look "
               "through ssh.\n\n"
               "Examples:\n"
               "  vdna serve --port 8070\n"
               "  ssh -L 8070:127.0.0.1:8070 ROBOT vdna serve");
}

} // namespace

std::optional<Options> read_command_line(int argc, const char *const *argv)
{
    CLI::App app(about, "vdna serve");
    Options options;
    describe(app, options);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success &answered) {
        app.exit(answered);
        return std::nullopt;
    } catch (const CLI::ParseError &error) {
        throw program::UsageError(std::string(error.what()) + "; see vdna serve --help");
    }
    return options;
}

usage::Command described_command_line()
{
    CLI::App app(about);
    Options options;
    describe(app, options);
    return usage::described(app, "vdna_serve");
}

} // namespace vdna::serve
