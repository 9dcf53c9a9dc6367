#include "vdna/options.hpp"

#include <iostream>
#include <map>

#include "record/ranges.hpp"

namespace vdna::tool
{

void add_network_options(CLI::App &command, NetworkOptions &options,
                         const std::string &default_text)
{
    command
        .add_option("--backbone", options.backbone,
                    "network: name of a manifest, path of a .toml, or path of a plug-in, "
                    "./libNAME.so (default: " +
                        default_text + ")")
        ->type_name("NAME|PATH");
    add_threads_option(command, options.threads);
}

void add_threads_option(CLI::App &command, uint32_t &threads)
{
    command.add_option("--threads", threads, "compute threads of the network")
        ->check(CLI::Range(1u, VDNA_BACKBONE_THREADS_MAX).description(""))
        ->type_name("1.." + std::to_string(VDNA_BACKBONE_THREADS_MAX))
        ->capture_default_str();
}

void add_source_options(CLI::App &command, frames::SourceOptions &options)
{
    command
        .add_option("--rate", options.rate_hz,
                    "frames per second of pictures whose labels have no utime")
        ->check(CLI::Validator(CLI::PositiveNumber).description(""))
        ->type_name("HZ")
        ->capture_default_str();
    command.add_option("--camera", options.camera, "camera channel of an LCM log")
        ->type_name("CHANNEL")
        ->capture_default_str();
    command.add_option("--every", options.every, "use only every N-th frame")
        ->check(CLI::Range(uint64_t{1}, uint64_t{1} << 32).description(""))
        ->type_name("N")
        ->capture_default_str();
    command.add_flag("--skip-bad", options.skip_bad,
                     "leave out frames that cannot be decoded or are missing, and count them");
    add_time_options(command, options);
}

void add_time_options(CLI::App &command, frames::SourceOptions &options)
{
    const std::map<std::string, uint32_t> units = {{"auto", VDNA_TIME_UNIT_AUTO},
                                                   {"us", VDNA_TIME_UNIT_US},
                                                   {"ns", VDNA_TIME_UNIT_NS},
                                                   {"ms", VDNA_TIME_UNIT_MS},
                                                   {"s", VDNA_TIME_UNIT_S}};
    command
        .add_option("--time-unit", options.time_unit,
                    "unit of time stamps; auto recognises it by their size and spacing")
        ->transform(CLI::CheckedTransformer(units).description(""))
        ->type_name("auto|us|ns|ms|s")
        ->default_str("auto");
    command
        .add_option("--late", options.late_s,
                    "leave out a frame up to this much older than the newest; an older one is a "
                    "step back of camera time")
        ->check(CLI::Range(0.0, 1e6).description(""))
        ->type_name("SECONDS")
        ->capture_default_str();
}

void add_warmup_min_option(CLI::App &command, uint32_t &frames_min)
{
    command
        .add_option("--warmup-min", frames_min,
                    "fewest frames of a warmup in seconds, which goes on until it has them")
        ->check(CLI::Range(1u, 1000000u).description(""))
        ->type_name("N")
        ->capture_default_str();
}

void tell(const std::string &source, const frames::Account &account)
{
    for (const std::string &sentence : sentences_of(account))
        std::cerr << "vdna: " << source << ": " << sentence << '\n';
}

void add_labels_option(CLI::App &command, frames::SourceOptions &options)
{
    command
        .add_option("--labels", options.labels,
                    "table with the columns file or frame, and place, or x,y[,z] in metres, or "
                    "lat,lon[,alt] in degrees, and utime in microseconds if known; empty cells: no "
                    "ground truth (default: SOURCE/labels.csv if it exists)")
        ->type_name("CSV");
    command
        .add_option("--frame", options.label_options.local_frame,
                    "name of the local frame of x,y[,z]: positions compare only within a frame "
                    "(default: column position_frame of the table, else local)")
        ->check([](const std::string &name) {
            vdna_error why{};
            return vdna_name_check(name.c_str(), &why) == VDNA_OK ? ""
                                                                  : "it " + std::string(why.text);
        })
        ->type_name("NAME");
}

void add_altitude_option(CLI::App &command, bool &with_altitude)
{
    command.add_flag("--with-altitude", with_altitude,
                     "tolerances in metres also count altitude (default: horizontal distances)");
}

void add_range_rule_option(CLI::App &command, uint32_t &rule)
{
    const std::map<std::string, uint32_t> rules = {
        {record::range_rules[VDNA_RANGE_ABOUT_MIDPOINT], VDNA_RANGE_ABOUT_MIDPOINT},
        {record::range_rules[VDNA_RANGE_ABOUT_ZERO], VDNA_RANGE_ABOUT_ZERO}};
    command
        .add_option(
            "--range-rule", rule,
            "calibration: widen the observed range by 1.2 about its midpoint, or about zero")
        ->transform(CLI::CheckedTransformer(rules).description(""))
        ->type_name("midpoint|zero")
        ->default_str(record::range_rules[rule]);
}

} // namespace vdna::tool
