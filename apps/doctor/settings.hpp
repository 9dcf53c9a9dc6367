// The settings of the daemon, as the vdna_selectord that is installed beside us reads them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <vdna/backbone.h>
#include <vdna/transport.h>

#include "doctor/verdict.hpp"

namespace vdna::doctor
{

// What the command line names; "" = not named.
struct Named {
    std::string file, map, url;
};

// The settings of the service, as its package installs them.
constexpr const char *packaged_settings = "/etc/vdna/vdna.toml";

// The members hold what counts where no daemon is installed.
struct Settings {
    std::string file; // of TOML; "" = none, all defaults
    std::string map = "/var/lib/vdna/map";
    std::string manifest = VDNA_BACKBONE_DEFAULT;
    std::string runtime; // "" = found automatically
    uint32_t threads = VDNA_BACKBONE_THREADS_DEFAULT;
    std::string url; // never ""
    std::vector<std::string> sources;
    std::string camera = VDNA_CHANNEL_CAMERA, status = VDNA_CHANNEL_STATUS;
    bool require_protection = false;
    uint32_t max_image_bytes = 2u << 20;
    bool lock_memory = false;
    uint64_t budget_mb = 0; // 0 = no limit
    std::string affinity;   // "" = all processors of the process
};

// What starting the daemon up to its loop told, by --print-memory.
struct Trial {
    std::string program;     // path of vdna_selectord; "" = it is not installed
    std::string version;     // "" = it does not say
    std::string refusal;     // its sentence about the settings; "" = they are valid
    std::string failure;     // its sentence about map, network or processors; "" = it would start
    uint64_t held_bytes = 0; // most memory that it holds and the system cannot take back
};

// Read the settings, and complete `out_trial` but for what try_start() finds. Throws Error only if
// our own files of settings cannot be understood.
Settings read_settings(const Named &named, Trial &out_trial);

// Let the daemon open its map and its network.
void try_start(const Named &named, const Settings &settings, Trial &trial);

Verdict check_settings(const Settings &settings, const Trial &trial);

// known: why map or network cannot be used, which is said already; "" = they can. own: our version
Verdict check_start(const Trial &trial, const std::string &known, const std::string &own);

} // namespace vdna::doctor
