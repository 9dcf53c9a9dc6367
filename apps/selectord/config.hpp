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

// Every setting; the members hold the defaults.
struct Config {
    std::string map_directory = "/var/lib/vdna/map";
    bool copy_map = true;          // otherwise mapped: memory that the system may take back
    bool leave_out_damaged = true; // serve a map without experiences that are damaged
    std::string manifest = VDNA_BACKBONE_DEFAULT; // bare name, or path of a .toml or a .so
    uint32_t threads = VDNA_BACKBONE_THREADS_DEFAULT;
    std::string runtime; // path of libonnxruntime.so; "" = found automatically
    // Run the network in a process of its own, except for a replay.
    bool backbone_process = true;
    // Milliseconds that it may then take for a picture; 0 = ten times what it takes at the start,
    // at least 500.
    uint32_t budget_ms = 0;
    uint32_t warmup_frames = VDNA_WARMUP_FRAMES_DEFAULT; // 0 = by time
    double warmup_seconds = 0; // 0 = by frames; exactly one of the two is set
    uint32_t warmup_frames_min = VDNA_WARMUP_FRAMES_MIN_DEFAULT;
    // A camera frame this much older than the newest is late and left out.
    double late_seconds = VDNA_TIME_LATE_US_DEFAULT / 1e6;
    // Localise in so many of the first experiences of the ranking at once.
    uint32_t top = 1;
    std::string rank = "transfer"; // where labels allow it, otherwise, or as "emd", by distance
    double min_recall = 0;         // NONE_FITS if a lower one is predicted of the best experience
    bool stop_early = true;        // choose as soon as the choice has settled
    bool reselect = true;          // choose again while driving; only with the place filter
    double switch_cost = trust_defaults().switch_cost; // frames that a switch must gain
    std::string pin; // name of an experience to localise in whatever the ranking says; "" = none
    bool shadow = false;      // recommend only: the first choice stays
    bool place_filter = true; // otherwise by the nearest frame alone
    double min_confidence = VDNA_LOCALISE_MIN_CONFIDENCE_DEFAULT; // below it an answer is UNSURE
    double tolerance = 5;     // metres, or place numbers: as far apart, frames are the same place
    bool frame_health = true; // leave out pictures that show nothing, or nothing new
    double stale_seconds = 0; // without a used frame, until STALE; 0 = 1 s and two frames' time
    std::string sources; // IPv4 addresses that may send, "10.0.0.2,10.0.0.3"; "" = see transport.h
    bool require_protection = false; // refuse camera frames without a checksum
    bool standby = true;             // serve only if no other daemon does on the same channels
    std::string url;                 // "" = $LCM_DEFAULT_URL, else LCM's default
    std::string camera_channel = VDNA_CHANNEL_CAMERA;
    std::string command_channel = VDNA_CHANNEL_COMMAND;
    std::string command_result_channel = VDNA_CHANNEL_COMMAND_RESULT;
    std::string ranking_channel = VDNA_CHANNEL_RANKING;
    std::string localisation_channel = VDNA_CHANNEL_LOCALISATION;
    std::string status_channel = VDNA_CHANNEL_STATUS;
    uint32_t max_image_bytes = 2u << 20;  // raw 640x480 in colour, or any JPEG of max_image_pixels
    uint32_t max_image_pixels = 2u << 20; // 1920x1080
    uint32_t budget_mb = 0;               // 2^20 bytes; 0 = no limit
    bool lock_memory = false;
    std::string affinity; // as for taskset: "0,2-3"; "" = all processors of the process
    int32_t nice = 0;     // added to the niceness of the process
};

// Read a TOML file. Throws Error with file, line and column for a key that is unknown, of the wrong
// type or out of range.
Config read_config(const std::string &path);

// Write all settings as TOML for read_config().
void print_config(const Config &config, std::ostream &out);

} // namespace vdna::selectord
