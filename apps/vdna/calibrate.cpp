// vdna calibrate - finds the ranges of a backbone from pictures and writes them to a file, or lets
// a map find out about itself.
#include <optional>

#include <vdna/cpp/map.hpp>
#include <vdna/cpp/map_update.hpp>

#include "program/decimal.hpp"
#include "program/exit_code.hpp"
#include "program/print.hpp"
#include "record/map_trust.hpp"
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
    std::string trust; // a map
    std::optional<double> tolerance;
};

void calibrate_trust(const CalibrateOptions &options)
{
    if (!options.out.empty())
        throw program::UsageError("--trust takes what the map has: expected no OUT.json and no "
                                  "SOURCE with it");
    const MapUpdate alone(options.trust); // nobody else changes the map meanwhile
    record::renew_map_trust(options.trust, options.tolerance);
    const Map map(options.trust);
    const record::SelfKnowledge self = record::self_knowledge_of(options.trust, map.experiences());
    std::cout << options.trust << "/" VDNA_MAP_TRUST_FILE ": " << self.sentence << '\n';
}

void calibrate_ranges(CalibrateOptions options)
{
    if (options.sources.empty())
        throw program::UsageError("expected OUT.json and SOURCE, or --trust MAP");
    if (options.tolerance)
        throw program::UsageError("--tolerance belongs to --trust MAP");
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
        "calibrate",
        "Find the ranges of a backbone from pictures, and write them to a file; or let "
        "a map find out how well it predicts its recall");
    const auto options = std::make_shared<CalibrateOptions>();
    options->network.backbone = VDNA_BACKBONE_DEFAULT;
    command->add_option("OUT.json", options->out, "ranges file to write, JSON")->type_name("PATH");
    command
        ->add_option("SOURCE", options->sources, "folder of pictures, video, LCM log or MCAP file")
        ->type_name("PATH");
    command
        ->add_option(
            "--trust", options->trust,
            "in place of OUT.json and SOURCE: write MAP/" VDNA_MAP_TRUST_FILE
            ", what the map knows about itself. Each experience plays the live run against "
            "every other; those that the file knows already are not played again")
        ->type_name("DIR");
    command
        ->add_option("--tolerance", options->tolerance,
                     "with --trust: metres or place numbers within which frames show one place "
                     "(default: that of the file, else 5)")
        ->check(program::within(0, 1e6))
        ->type_name("T");
    add_network_options(*command, options->network, VDNA_BACKBONE_DEFAULT);
    add_source_options(*command, options->source);
    add_range_rule_option(*command, options->rule);
    command->add_flag("--force", options->force, "replace OUT.json if it exists");
    command->footer("Examples:\n"
                    "  vdna calibrate ranges.json winter/ summer/\n"
                    "  vdna build --ranges ranges.json park winter/\n"
                    "  vdna calibrate --trust park --tolerance 10");
    command->callback([options] {
        options->trust.empty() ? calibrate_ranges(*options) : calibrate_trust(*options);
    });
}

} // namespace vdna::tool
