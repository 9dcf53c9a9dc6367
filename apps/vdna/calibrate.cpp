// vdna calibrate - finds the ranges of a backbone from pictures and writes them to a file.
#include "program/print.hpp"
#include "record/pass.hpp"
#include "record/ranges.hpp"
#include "vdna/commands.hpp"
#include "vdna/options.hpp"

namespace vdna::tool
{

namespace
{

struct CalibrateOptions {
    std::string out;
    std::vector<std::string> sources;
    NetworkOptions network;
    frames::SourceOptions source;
    uint32_t rule = VDNA_RANGE_ABOUT_MIDPOINT;
    bool force = false;
};

void calibrate(CalibrateOptions options)
{
    if (std::filesystem::exists(options.out) && !options.force)
        throw Error(options.out + ": exists already; replace it with --force");
    options.source.labelled = false;
    Backbone backbone(options.network.backbone, options.network.threads);
    record::Calibration calibration(backbone.info());
    uint64_t frames = 0, bad = 0;
    for (const std::string &source : options.sources) {
        record::Pass pass(source, options.source, backbone);
        for (; pass.next(); frames++)
            calibration.observe(pass.output(), pass.frame().name);
        bad += pass.account().bad;
        tell(source, pass.account());
    }
    if (frames == 0)
        throw Error("none of the " + std::to_string(bad) + " frames can be used");
    record::write_ranges(calibration.ranges(options.rule), options.rule, options.out);
    std::cout << options.out << ": ranges of " << backbone.info().identity.neurons
              << " neurons from " << frames << " frames\n";
}

} // namespace

void add_calibrate(CLI::App &app)
{
    CLI::App *command = app.add_subcommand(
        "calibrate", "Find the ranges of a backbone from pictures, and write them to a file");
    const auto options = std::make_shared<CalibrateOptions>();
    options->network.backbone = VDNA_BACKBONE_DEFAULT;
    command->add_option("OUT.json", options->out, "ranges file to write, JSON")
        ->type_name("")
        ->required();
    command->add_option("SOURCE", options->sources, "folder of pictures, video file or LCM log")
        ->type_name("")
        ->required();
    add_network_options(*command, options->network, VDNA_BACKBONE_DEFAULT);
    add_source_options(*command, options->source);
    add_range_rule_option(*command, options->rule);
    command->add_flag("--force", options->force, "replace OUT.json if it exists");
    command->footer("Examples:\n"
                    "  vdna calibrate ranges.json winter/ summer/\n"
                    "  vdna build --ranges ranges.json park winter/");
    command->callback([options] { calibrate(*options); });
}

} // namespace vdna::tool
