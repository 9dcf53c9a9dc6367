#include "doctor/machine.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <system_error>

#include <sys/stat.h>
#include <unistd.h>

#include "doctor/network.hpp"
#include "doctor/system_files.hpp"

namespace vdna::doctor
{

namespace
{

namespace fs = std::filesystem;

constexpr const char *unit_name = "vdna_selectord.service";
constexpr uint64_t mib = 1u << 20;

// The soft limit of /proc/self/limits; nothing = unlimited.
std::optional<uint64_t> read_memory_lock_limit(const fs::path &root)
{
    const std::string limits = read_text(root / "proc/self/limits").value_or("");
    return number_in(value_of(limits, "Max locked memory"));
}

bool read_may_lock(const fs::path &root)
{
    constexpr unsigned ipc_lock = 14; // CAP_IPC_LOCK
    const std::string held = value_of(read_text(root / "proc/self/status").value_or(""), "CapEff");
    return std::strtoull(held.c_str(), nullptr, 16) >> ipc_lock & 1;
}

std::optional<uint64_t> read_available(const fs::path &root)
{
    const std::string memory = read_text(root / "proc/meminfo").value_or("");
    const std::optional<uint64_t> kib = number_in(value_of(memory, "MemAvailable"));
    return kib ? std::optional<uint64_t>(*kib * 1024) : std::nullopt;
}

bool is_there(const fs::path &path)
{
    std::error_code none;
    return fs::exists(fs::symlink_status(path, none));
}

bool is_yes(const std::string &text, const char *name)
{
    const std::string value = value_of(text, name);
    return value == "yes" || value == "true";
}

Unit read_unit(const fs::path &root)
{
    Unit unit;
    unit.is_managed = is_there(root / "run/systemd/system");
    unit.has_settings = is_there(root / fs::path(packaged_settings).relative_path());
    unit.has_old_settings = is_there(root / "etc/vdna.toml");
    for (const char *folder :
         {"etc/systemd/system", "lib/systemd/system", "usr/lib/systemd/system"})
        if (unit.file.empty() && is_there(root / folder / unit_name))
            unit.file = root / folder / unit_name;
    const std::string text = read_text(unit.file).value_or("");
    unit.is_other_user = is_yes(text, "DynamicUser");
    if (const std::string state = value_of(text, "StateDirectory"); !state.empty())
        unit.state = "/var/lib/" + state;
    unit.hides_home = is_yes(text, "ProtectHome");
    unit.hides_temporary = is_yes(text, "PrivateTmp");
    unit.is_enabled = is_there(root / "etc/systemd/system/multi-user.target.wants" / unit_name);
    unit.is_active = is_there(root / "sys/fs/cgroup/system.slice" / unit_name);
    return unit;
}

// The first part of a path that a user who owns nothing cannot read; "" if there is none.
std::string barrier_of(const fs::path &path)
{
    fs::path part;
    for (const fs::path &name : path) {
        part /= name;
        struct stat about{};
        if (stat(part.c_str(), &about) != 0)
            return part;
        const bool is_way = S_ISDIR(about.st_mode) && part != path;
        const mode_t needed = is_way                   ? S_IXOTH
                              : S_ISDIR(about.st_mode) ? S_IROTH | S_IXOTH
                                                       : S_IROTH;
        if ((about.st_mode & needed) != needed)
            return part;
    }
    return "";
}

Access access_to(const fs::path &named)
{
    const fs::path path = fs::absolute(named).lexically_normal();
    return {path, access(path.c_str(), R_OK) == 0, barrier_of(path)};
}

std::vector<Access> read_access(const Settings &settings)
{
    std::vector<Access> files;
    if (!settings.file.empty())
        files.push_back(access_to(settings.file));
    if (settings.manifest.find('/') != std::string::npos)
        files.push_back(access_to(settings.manifest));
    files.push_back(access_to(settings.map));
    std::error_code none;
    for (const auto &entry : fs::directory_iterator(settings.map, none))
        if (entry.is_regular_file(none))
            files.push_back(access_to(entry.path()));
    return files;
}

std::vector<Disk> read_disks(const Settings &settings)
{
    std::vector<Disk> disks;
    std::error_code none;
    const std::array<Disk, 2> all{
        {{"the map", settings.map, 0}, {"temporary files", fs::temp_directory_path(none), 0}}};
    for (const Disk &disk : all) {
        const fs::space_info space = fs::space(disk.path, none);
        if (!none)
            disks.push_back({disk.use, disk.path, space.available});
    }
    return disks;
}

bool is_below(const std::string &path, std::initializer_list<const char *> folders)
{
    return std::any_of(folders.begin(), folders.end(),
                       [&](const std::string &folder) { return path.rfind(folder + "/", 0) == 0; });
}

// systemd gives this folder to the service's user, and hides it from others.
bool is_in_state(const Access &file, const Unit &unit)
{
    return !unit.state.empty() && is_below(file.path, {unit.state.c_str()});
}

// Why the service cannot read a file that we can; ok if it can.
Verdict access_of_service(const Access &file, const Unit &unit)
{
    if (unit.hides_home && is_below(file.path, {"/home", "/root", "/run/user"}))
        return broken(file.path + " is hidden from the service by ProtectHome=yes",
                      "move it to /var/lib/vdna, or `systemctl edit vdna_selectord`: "
                      "ProtectHome=read-only");
    if (unit.hides_temporary && is_below(file.path, {"/tmp", "/var/tmp"}))
        return broken(file.path + " is hidden from the service by PrivateTmp=yes",
                      "move it to /var/lib/vdna");
    if (unit.is_other_user && !file.barrier.empty() && !is_in_state(file, unit))
        return broken(file.barrier + " cannot be read by the service's user",
                      "sudo chmod o+rX " + file.barrier);
    return ok("");
}

} // namespace

MachineFacts read_machine(const std::filesystem::path &root, const Settings &settings)
{
    MachineFacts machine;
    machine.memory_lock_limit = read_memory_lock_limit(root);
    machine.may_lock = read_may_lock(root);
    machine.available_bytes = read_available(root);
    machine.disks = read_disks(settings);
    machine.files = read_access(settings);
    machine.unit = read_unit(root);
    return machine;
}

Verdict check_lock(const MachineFacts &machine, const Settings &settings, const Trial &trial)
{
    if (!settings.lock_memory)
        return ok("not wanted: [memory] lock = false");
    if (machine.may_lock)
        return ok("wanted, and allowed without a limit by CAP_IPC_LOCK");
    if (!machine.memory_lock_limit)
        return ok("wanted, and allowed without a limit");
    const std::string limit = bytes_text(*machine.memory_lock_limit);
    if (trial.held_bytes == 0)
        return unknown("up to " + limit + " may be locked; what is needed is not known: see start");
    if (*machine.memory_lock_limit >= trial.held_bytes)
        return ok("wanted, and up to " + limit + " may be locked");
    return broken("[memory] lock = true, but at most " + limit + " of " +
                      bytes_text(trial.held_bytes) + " may be locked",
                  "ulimit -l unlimited; for the service `systemctl edit vdna_selectord`: [Service] "
                  "LimitMEMLOCK=infinity");
}

Verdict check_memory(const MachineFacts &machine, const Trial &trial, const program::Json &status)
{
    if (trial.held_bytes == 0)
        return unknown("not known what the daemon needs: see start");
    if (!machine.available_bytes)
        return unknown("the system does not tell how much is available");
    const uint64_t taken =
        status.is_object() ? status.value("resident_bytes", uint64_t{0}) : uint64_t{0};
    const std::string found = "the daemon holds at most " + bytes_text(trial.held_bytes) + ", " +
                              bytes_text(*machine.available_bytes) + " are available";
    if (trial.held_bytes > *machine.available_bytes + taken)
        return broken(found,
                      "end other programs, set map.copy = false, or take a smaller network; see "
                      "`vdna_selectord --print-memory`");
    return ok(found);
}

Verdict check_disk(const MachineFacts &machine, uint64_t experience_bytes)
{
    const uint64_t wanted = std::max(100 * mib, 2 * experience_bytes);
    if (machine.disks.empty())
        return unknown("the system does not tell how much is free");
    std::string list;
    for (const Disk &disk : machine.disks) {
        list += (list.empty() ? "" : ", ") + bytes_text(disk.free_bytes) +
                (list.empty() ? " free for " : " for ") + disk.use;
        if (disk.free_bytes < wanted)
            return warn(bytes_text(disk.free_bytes) + " free for " + disk.path +
                            ": too little for another experience, " + bytes_text(wanted),
                        "remove what is not needed; `du -xh " + disk.path + " | sort -h` shows it");
    }
    return ok(list);
}

Verdict check_access(const MachineFacts &machine)
{
    const Unit &unit = machine.unit;
    for (const Access &file : machine.files) {
        if (!file.for_us && unit.is_other_user && is_in_state(file, unit))
            return unknown(file.path + " is the service's own; see it with sudo vdna doctor");
        if (!file.for_us)
            return broken(file.path + " cannot be read by this user",
                          is_there(file.path) ? "sudo chmod a+rX " + file.path
                                              : "make it, or name another one");
        if (unit.file.empty())
            continue;
        const Verdict verdict = access_of_service(file, unit);
        if (verdict.grade != Grade::ok)
            return verdict;
    }
    return ok(unit.file.empty() ? "settings and map can be read by this user"
                                : "settings and map can be read, by the service too");
}

Verdict check_unit(const Unit &unit)
{
    if (!unit.is_managed)
        return unknown("systemd does not run this machine");
    if (unit.file.empty())
        return warn(std::string(unit_name) + " is not installed: nothing starts the daemon",
                    "install the package vdna-selectord");
    if (!unit.has_settings)
        return broken(std::string("the service does not start: there is no ") + packaged_settings,
                      std::string("vdna_selectord --print-config | sudo tee ") + packaged_settings +
                          ", then edit it");
    if (unit.has_old_settings)
        return warn("/etc/vdna.toml is no longer read",
                    std::string("sudo mv /etc/vdna.toml ") + packaged_settings);
    if (!unit.is_active)
        return broken("the service does not run",
                      "sudo systemctl enable --now vdna_selectord; `journalctl -u vdna_selectord` "
                      "says why it ended");
    if (!unit.is_enabled)
        return warn("the service runs, but will not start with the machine",
                    "sudo systemctl enable vdna_selectord");
    return ok("enabled and running");
}

} // namespace vdna::doctor
