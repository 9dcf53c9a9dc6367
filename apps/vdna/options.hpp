// Command-line options that several sub-commands share.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include <vdna/backbone.h>

#include "frames/source.hpp"

namespace vdna::tool
{

// The network and its threads.
struct NetworkOptions {
    std::string backbone; // manifest name or path; "" = the sub-command's default
    uint32_t threads = VDNA_BACKBONE_THREADS_DEFAULT;
};

// default_text: the default, for --help.
void add_network_options(CLI::App &command, NetworkOptions &options,
                         const std::string &default_text);

// --threads
void add_threads_option(CLI::App &command, uint32_t &threads);

// --rate, --camera, --every, --skip-bad, --time-unit, --late.
void add_source_options(CLI::App &command, frames::SourceOptions &options);

// --time-unit, --late.
void add_time_options(CLI::App &command, frames::SourceOptions &options);

// --warmup-min
void add_warmup_min_option(CLI::App &command, uint32_t &frames_min);

// Tell on standard error what is to be known about a source that was read.
void tell(const std::string &source, const frames::Account &account);
// --gps, --pose-channel, --gps-gap, --time-offset.
void add_track_options(CLI::App &command, frames::SourceOptions &options);

// --gps-gap
void add_gap_option(CLI::App &command, double &gap_s);

// --labels, --frame.
void add_labels_option(CLI::App &command, frames::SourceOptions &options);

// --frame
void add_frame_option(CLI::App &command, std::string &frame);

// --with-altitude.
void add_altitude_option(CLI::App &command, bool &with_altitude);

// --range-rule; rule: VDNA_RANGE_ABOUT_...
void add_range_rule_option(CLI::App &command, uint32_t &rule);

// --no-trust
void add_no_trust_option(CLI::App &command, bool &no_trust);

// The size of a picture, in pixels.
struct PictureSize {
    uint32_t width, height;
};

// --size WIDTHxHEIGHT, sides within least..most; example: for the complaint. Throws UsageError.
PictureSize parse_size(const std::string &text, uint32_t least, uint32_t most,
                       const std::string &example);

} // namespace vdna::tool
