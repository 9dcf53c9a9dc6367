#include "vdna/options.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>

#include "frames/iso_time.hpp"
#include "program/decimal.hpp"
#include "program/exit_code.hpp"
#include "record/map_trust.hpp"
#include "record/ranges.hpp"

namespace vdna::tool
{

namespace
{

// --time-offset in microseconds.
int64_t parse_offset(const std::string &text)
{
    constexpr double longest_s = 1e11; // 3000 years
    if (const std::optional<int64_t> utime = frames::utime_of_iso(text))
        return *utime;
    const std::optional<double> seconds = program::decimal(text);
    if (!seconds || std::abs(*seconds) > longest_s)
        throw program::UsageError("--time-offset " + text +
                                  ": expected seconds, as in -3.5, or a time, as in "
                                  "2024-05-01T12:00:00Z");
    return std::llround(*seconds * 1e6);
}

} // namespace

void add_network_options(CLI::App &command, NetworkOptions &options,
                         const std::string &default_text)
{
    command
        .add_option("--backbone", options.backbone,
                    "network: name of a manifest, path of a .toml, or path of a plug-in, "
                    "./libNAME.so (default: " +
                        default_text + ")")
        ->type_name("NETWORK|PATH");
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
                    "frames per second of pictures and videos that have no times")
        ->check(program::within(1e-6, 1e6))
        ->type_name("HZ")
        ->capture_default_str();
    command
        .add_option("--camera", options.camera,
                    "camera channel of an LCM log, or topic of an MCAP file, whose only "
                    "topic with compressed pictures needs no name")
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
                    "unit of time stamps: us, ns, ms, s, or auto, which recognises it by their "
                    "size and spacing")
        ->transform(CLI::CheckedTransformer(units).description("{auto,us,ns,ms,s}"))
        ->type_name("UNIT")
        ->default_str("auto");
    command
        .add_option("--late", options.late_s,
                    "leave out a frame up to this much older than the newest; an older one is a "
                    "step back of camera time")
        ->check(program::within(0, 1e6))
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
        ->type_name("FILE");
    add_frame_option(command, options.label_options.local_frame);
}

void add_frame_option(CLI::App &command, std::string &frame)
{
    command
        .add_option("--frame", frame,
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

void add_gap_option(CLI::App &command, double &gap_s)
{
    command
        .add_option("--gps-gap", gap_s,
                    "frames between two fixes of a track that are further apart have no position")
        ->check(program::within(0.001, 3600))
        ->type_name("SECONDS")
        ->capture_default_str();
}

void add_track_options(CLI::App &command, frames::SourceOptions &options)
{
    CLI::Option *gps =
        command
            .add_option("--gps", options.gps,
                        "track of the drive, .gpx or a table with the columns time, lat, lon and "
                        "possibly alt: gives each frame its position, in place of a table's")
            ->type_name("FILE");
    command
        .add_option("--pose-channel", options.pose_channel,
                    "channel of an LCM log with the poses (bot_core.pose_t) or GPS fixes "
                    "(bot_core.gps_data_t) of the drive, or topic of an MCAP file with "
                    "foxglove.LocationFix or sensor_msgs' NavSatFix: as --gps")
        ->type_name("CHANNEL")
        ->excludes(gps);
    add_gap_option(command, options.gps_gap_s);
    command
        .add_option_function<std::string>(
            "--time-offset",
            [&options](const std::string &text) { options.time_offset_us = parse_offset(text); },
            "add to the times of the frames: seconds or, if they count from 0, the time of the "
            "first one, as in 2024-05-01T12:00:00Z")
        ->type_name("SECONDS|TIME");
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
        ->transform(CLI::CheckedTransformer(rules).description("{midpoint,zero}"))
        ->type_name("RULE")
        ->default_str(record::range_rules[rule]);
}

void add_no_trust_option(CLI::App &command, bool &no_trust)
{
    command.add_flag("--no-trust", no_trust,
                     "do not renew MAP/" VDNA_MAP_TRUST_FILE
                     ", for which each new experience plays every other one: the map predicts no "
                     "recall until `vdna calibrate --trust MAP`");
}

PictureSize parse_size(const std::string &text, uint32_t least, uint32_t most,
                       const std::string &example)
{
    PictureSize size{};
    const char *end = text.data() + text.size();
    const auto width = std::from_chars(text.data(), end, size.width);
    const bool crossed = width.ec == std::errc() && width.ptr < end && *width.ptr == 'x';
    const auto height = std::from_chars(crossed ? width.ptr + 1 : end, end, size.height);
    if (height.ec != std::errc() || height.ptr != end ||
        std::min(size.width, size.height) < least || std::max(size.width, size.height) > most)
        throw program::UsageError("--size " + text + ": expected WIDTHxHEIGHT in pixels, " +
                                  std::to_string(least) + ".." + std::to_string(most) +
                                  " each, as in " + example);
    return size;
}

} // namespace vdna::tool
