// Command-line options that several sub-commands share.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "frames/source.hpp"

namespace vdna::tool
{

// The network and its threads.
struct NetworkOptions {
    std::string backbone; // manifest name or path; "" = the sub-command's default
    uint32_t threads = 2;
};

// default_backbone: for --help.
void add_network_options(CLI::App &command, NetworkOptions &options,
                         const std::string &default_backbone);

// --rate, --camera, --every, --skip-bad.
void add_source_options(CLI::App &command, frames::SourceOptions &options);

// --labels.
void add_labels_option(CLI::App &command, frames::SourceOptions &options);

// --range-rule; rule: VDNA_RANGE_ABOUT_...
void add_range_rule_option(CLI::App &command, uint32_t &rule);

// The backbone used if neither the user nor a map names one.
extern const char *const default_backbone;

} // namespace vdna::tool
