// What the system grants the daemon: memory, locks, disk, files, its unit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "doctor/settings.hpp"
#include "program/print.hpp"

namespace vdna::doctor
{

// The service, as systemd finds it.
struct Unit {
    bool is_managed = false; // systemd runs this machine
    std::string file;        // "" = not installed
    bool is_enabled = false, is_active = false;
    bool has_settings = false;     // packaged_settings, without which it does not start
    std::string state;             // folder that is its own, as /var/lib/vdna; "" = none
    bool has_old_settings = false; // /etc/vdna.toml, where they were before 0.2
    bool is_other_user = false;    // it runs as a user who owns nothing: DynamicUser=
    bool hides_home = false;       // ProtectHome=
    bool hides_temporary = false;  // PrivateTmp=
};

// A file or a folder that the daemon reads.
struct Access {
    std::string path;    // absolute
    bool for_us = false; // this user can read it
    std::string
        barrier; // the first part of the path that users who own nothing cannot read; "" = none
};

struct Disk {
    std::string use; // "the map"
    std::string path;
    uint64_t free_bytes;
};

struct MachineFacts {
    std::optional<uint64_t> memory_lock_limit; // bytes; nothing = unlimited
    bool may_lock = false;                     // CAP_IPC_LOCK: the limit does not apply
    std::optional<uint64_t> available_bytes;   // memory; nothing = not known
    std::vector<Disk> disks;
    std::vector<Access> files;
    Unit unit;
};

MachineFacts read_machine(const std::filesystem::path &root, const Settings &settings);

Verdict check_lock(const MachineFacts &machine, const Settings &settings, const Trial &trial);

// status: of a daemon of this machine, null if there is none, whose memory is taken already
Verdict check_memory(const MachineFacts &machine, const Trial &trial, const program::Json &status);

// experience_bytes: of the largest of the map
Verdict check_disk(const MachineFacts &machine, uint64_t experience_bytes);
Verdict check_access(const MachineFacts &machine);
Verdict check_unit(const Unit &unit);

} // namespace vdna::doctor
