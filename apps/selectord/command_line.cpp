#include "selectord/command_line.hpp"

#include <CLI/CLI.hpp>

#include <vdna/cpp/error.hpp>
#include <vdna/cpp/selector.hpp>
#include <vdna/version.h>

#include "program/decimal.hpp"
#include "program/exit_code.hpp"

namespace vdna::selectord
{

namespace
{

// The given options; they override the file, regardless of their order.
struct Options {
    std::optional<std::string> file, map, backbone, url;
    std::optional<uint32_t> warmup_frames;
    std::optional<double> warmup_seconds;
};

const char *const about = "Choose, onboard and live, the recorded experience that fits the current "
                          "conditions, and localise in it";

const char *const footer = R"(
Camera frames (bot_core.image_t) come in over LCM. The first ones are compared with the Visual DNA
of every experience of the map; the one that promises most is chosen, unless none fits, and later
frames are localised in it. It is chosen again while driving ([select]). Answers go out on the channels of the [lcm] section; see --print-config for all settings.
Memory is fixed before it runs: --print-memory states it, [memory] budget_mb limits it; [cpu] sets
the processors. The network runs in a process of its own, which is started again if it crashes or
hangs ([backbone] process and budget_ms).

Prints "READY ..." on standard output once it listens, and events on standard error.
SIGTERM and SIGINT end it at once; `vdna command reset` makes it choose again. SIGHUP opens the
directory of the map again, while the old map serves.
After three seconds without progress, standard error and the status say why.

The URL of a log, file://PATH?speed=0, replays it: every frame is answered, in the file of --answers,
and the daemon ends with the log. The same log gives the same file.

Exit codes: 0 stopped by a signal, or the log has ended, or --check found no fault; 1 the map, the
network or the LCM connection cannot be used, the log is damaged or no frame of it could be
used, the answers cannot be written, or the system refuses the requested memory or processors; 2 the command line or
the configuration file is wrong.

Examples:
  vdna_selectord --print-config
  vdna_selectord -c vdna.toml --check
  vdna_selectord --map ~/maps/campus --warmup-frames 50 -l )" VDNA_LCM_URL R"(
  vdna_selectord --map ~/maps/campus -l 'file:///data/drive.log?speed=0' --answers drive.jsonl)";

void apply(const Options &options, Config &config)
{
    config.map_directory = options.map.value_or(config.map_directory);
    config.manifest = options.backbone.value_or(config.manifest);
    config.url = options.url.value_or(config.url);
    if (options.warmup_frames) {
        config.warmup_frames = *options.warmup_frames;
        config.warmup_seconds = 0;
    }
    if (options.warmup_seconds) {
        config.warmup_frames = 0;
        config.warmup_seconds = *options.warmup_seconds;
    }
}

void describe(CLI::App &app, Options &options, Invocation &invocation)
{
    usage::add_standard_options(app, std::string("vdna_selectord ") + vdna_version());
    app.add_option("-c,--config", options.file,
                   "read settings from this TOML file, which options override")
        ->type_name("FILE");
    app.add_option("--map", options.map, "directory of experience files")->type_name("DIR");
    app.add_option(
           "--backbone", options.backbone,
           "network the map was built with: a name, or the path of a .toml or of a plug-in, "
           "./libNAME.so, which is code")
        ->type_name("NETWORK|PATH");
    CLI::Option *frames =
        app.add_option("--warmup-frames", options.warmup_frames, "choose after this many frames")
            ->type_name("N")
            ->check(CLI::Range(uint32_t{1}, UINT32_MAX).description(""));
    app.add_option("--warmup-seconds", options.warmup_seconds, "choose after this much camera time")
        ->type_name("T")
        ->check(program::within(warmup_seconds_min, warmup_seconds_max))
        ->excludes(frames);
    app.add_option("-l,--lcm-url", options.url,
                   "LCM network, or a log to replay (default: $LCM_DEFAULT_URL, else LCM's)")
        ->type_name("URL");
    app.add_option("--answers", invocation.answers,
                   "also write every answer to this file, one JSON object per line, as `vdna watch "
                   "--json` prints them; an earlier file of answers is emptied, another file is "
                   "refused")
        ->type_name("PATH");
    app.add_flag("--print-config", invocation.print_config,
                 "print the settings in force as TOML, each with its meaning, and exit");
    app.add_flag("--check", invocation.check,
                 "open the map and the network, report whether they fit, and exit");
    CLI::Option *memory =
        app.add_flag("--print-memory", invocation.print_memory,
                     "also open map and network, state all memory that will be held, and exit");
    app.add_flag("--json", invocation.json, "with --print-memory: as JSON")->needs(memory);
    app.footer(footer);
}

} // namespace

std::optional<Invocation> read_command_line(int argc, const char *const *argv)
{
    CLI::App app(about, "vdna_selectord");
    Options options;
    Invocation invocation;
    describe(app, options, invocation);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success &answered) {
        app.exit(answered);
        return std::nullopt;
    } catch (const CLI::ParseError &error) {
        throw program::UsageError(std::string(error.what()) + "; see `vdna_selectord --help`");
    }
    if (options.file)
        invocation.config = read_config(*options.file);
    apply(options, invocation.config);
    if (invocation.print_config) // for a file in any folder
        make_paths_absolute(invocation.config);
    return invocation;
}

usage::Command described_command_line()
{
    CLI::App app(about, "vdna_selectord");
    Options options;
    Invocation invocation;
    describe(app, options, invocation);
    return usage::described(app, "vdna_selectord");
}

} // namespace vdna::selectord
