// The settings of vdna_selectord: defaults, limits, and their TOML file.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

#include <vdna/backbone.h>
#include <vdna/cpp/trust.hpp>
#include <vdna/select.h>
#include <vdna/transport.h>

namespace vdna::selectord
{

// Every setting; the members hold the defaults. What each means, print_config() says.
struct Config {
    std::string map_directory = "/var/lib/vdna/map";
    bool copy_map = true;
    bool leave_out_damaged = true;
    std::string manifest = VDNA_BACKBONE_DEFAULT;
    uint32_t threads = VDNA_BACKBONE_THREADS_DEFAULT;
    std::string runtime;
    bool backbone_process = true; // but never for a replay
    uint32_t budget_ms = 0;
    uint32_t warmup_frames = VDNA_WARMUP_FRAMES_DEFAULT; // 0 = by time
    double warmup_seconds = 0; // 0 = by frames; exactly one of the two is set
    uint32_t warmup_frames_min = VDNA_WARMUP_FRAMES_MIN_DEFAULT;
    double late_seconds = VDNA_TIME_LATE_US_DEFAULT / 1e6;
    bool warmup_distinct = false;
    uint32_t top = 1;
    std::string rank = "transfer";
    uint32_t exact_distances = 0; // 0 = all
    double min_recall = 0;
    bool stop_early = true;
    bool reselect = true;
    double switch_cost = trust_defaults().switch_cost;
    std::string pin;
    bool shadow = false;
    bool place_filter = true;
    double min_confidence = VDNA_LOCALISE_MIN_CONFIDENCE_DEFAULT;
    double tolerance = 5;
    double every_m = 0;
    bool frame_health = true;
    double parked = 1.5;
    double max_rate_hz = 0;
    double stale_seconds = 0;
    std::string sources; // "10.0.0.2,10.0.0.3"; "" = see transport.h
    bool require_protection = false;
    bool standby = true;
    std::string url; // "" = $LCM_DEFAULT_URL, else LCM's default
    std::string camera_channel = VDNA_CHANNEL_CAMERA;
    std::string command_channel = VDNA_CHANNEL_COMMAND;
    std::string command_result_channel = VDNA_CHANNEL_COMMAND_RESULT;
    std::string ranking_channel = VDNA_CHANNEL_RANKING;
    std::string localisation_channel = VDNA_CHANNEL_LOCALISATION;
    std::string status_channel = VDNA_CHANNEL_STATUS;
    uint32_t max_image_bytes = 2u << 20;  // raw 640x480 in colour, or any JPEG of max_image_pixels
    uint32_t max_image_pixels = 2u << 20; // 1920x1080
    uint32_t budget_mb = 0;
    bool lock_memory = false;
    std::string affinity;
    int32_t nice = 0;
};

// Read a TOML file; its paths are absolute then: ~/ and relative ones begin in HOME and in the
// file's folder. Throws Error with file, line and column for a key that is unknown, of the wrong
// type or out of range.
Config read_config(const std::string &path);

// Relative paths begin in the working directory.
void make_paths_absolute(Config &config);

// Write all settings as TOML for read_config(), each with its meaning, limits and default.
void print_config(const Config &config, std::ostream &out);

} // namespace vdna::selectord
