#include "doctor/doctor.hpp"

#include <algorithm>
#include <array>
#include <sstream>

#include <onnxruntime_c_api.h>
#include <unistd.h>

#include <vdna/version.h>

#include "doctor/camera.hpp"
#include "doctor/machine.hpp"
#include "doctor/map.hpp"
#include "doctor/network.hpp"
#include "doctor/processor.hpp"

namespace vdna::doctor
{

namespace
{

std::string host_name()
{
    std::array<char, 256> name{};
    gethostname(name.data(), name.size() - 1);
    return name.data();
}

// The daemon's status if it runs on this machine; null otherwise.
program::Json local(const program::Json &status, const std::string &host)
{
    return status.is_object() && status.value("host", "") == host ? status : program::Json();
}

// "" if map and network can be used.
const std::string &why_unusable(const MapFacts &map)
{
    if (!map.refusal.empty())
        return map.refusal;
    return map.network_refusal.empty() ? map.mismatch : map.network_refusal;
}

constexpr size_t columns = 80;

// Append words to a text, a new line beginning with blanks.
void add_wrapped(std::string &text, const std::string &words, size_t indent)
{
    size_t column = text.size() - (text.rfind('\n') + 1);
    bool is_first = true;
    std::istringstream in(words);
    for (std::string word; in >> word;) {
        const size_t width = word.size() + (is_first ? 0 : 1);
        if (column + width > columns && column > indent) {
            text += "\n" + std::string(indent, ' ');
            column = indent;
            is_first = true;
        }
        text += (is_first ? "" : " ") + word;
        column += word.size() + (is_first ? 0 : 1);
        is_first = false;
    }
    text += "\n";
}

std::string padded(std::string text, size_t width)
{
    text.resize(std::max(width, text.size()), ' ');
    return text + " ";
}

const char *word_of(Grade grade)
{
    switch (grade) {
    case Grade::ok:
        return "ok";
    case Grade::unknown:
        return "--";
    case Grade::warn:
        return "warn";
    default:
        return "FAIL";
    }
}

size_t count_of(const Diagnosis &diagnosis, Grade grade)
{
    return static_cast<size_t>(
        std::count_if(diagnosis.checks.begin(), diagnosis.checks.end(),
                      [grade](const Check &check) { return check.verdict.grade == grade; }));
}

std::string counted(size_t count, const char *what)
{
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string summary_of(const Diagnosis &diagnosis)
{
    const size_t failures = count_of(diagnosis, Grade::fail);
    const size_t warnings = count_of(diagnosis, Grade::warn);
    if (failures + warnings == 0)
        return "nothing is wrong";
    return counted(failures, "failure") + ", " + counted(warnings, "warning");
}

} // namespace

Diagnosis examine(const Named &named, double seconds, const std::filesystem::path &root)
{
    Trial trial;
    Diagnosis diagnosis;
    const Settings &settings = diagnosis.settings = read_settings(named, trial);
    const Heard heard = listen(settings, seconds);
    const MapFacts map = examine_map(settings);
    try_start(named, settings, trial);
    const NetworkFacts network = read_network(root, settings.url);
    const ProcessorFacts processor = read_processor(root);
    const MachineFacts machine = read_machine(root, settings);
    const std::string own = vdna_version(), host = host_name();

    diagnosis.checks = {
        {"network", "route", check_route(network)},
        {"network", "buffer", check_buffer(network)},
        {"network", "ttl", check_ttl(network, settings, heard)},
        {"network", "channels", check_channels(settings, heard)},
        {"camera", "frames", check_frames(settings, heard)},
        {"camera", "sender", check_sender(settings, heard)},
        {"camera", "stamps", check_stamps(heard)},
        {"map", "files", check_files(settings, map)},
        {"map", "network", check_network(map)},
        {"map", "trust", check_trust(map)},
        {"map", "daemon", check_daemon(settings, map, heard, own, host)},
        {"processor", "runtime", check_runtime(map, ORT_API_VERSION)},
        {"processor", "features", check_features(processor, map)},
        {"processor", "governor", check_governor(processor)},
        {"processor", "cores", check_cores(processor, settings)},
        {"system", "settings", check_settings(settings, trial)},
        {"system", "start", check_start(trial, why_unusable(map), own)},
        {"system", "memory", check_memory(machine, trial, local(heard.status, host))},
        {"system", "lock", check_lock(machine, settings, trial)},
        {"system", "disk", check_disk(machine, map.largest_bytes)},
        {"system", "access", check_access(machine)},
        {"system", "unit", check_unit(machine.unit)},
    };
    return diagnosis;
}

bool has_failed(const Diagnosis &diagnosis)
{
    return count_of(diagnosis, Grade::fail) > 0;
}

std::string screen_of(const Diagnosis &diagnosis)
{
    constexpr size_t group_width = 9, name_width = 8, word_width = 4;
    constexpr size_t found_at = word_width + group_width + name_width + 3, remedy_at = 5;
    std::string text, group;
    for (const Check &check : diagnosis.checks) {
        const std::string shown = group == check.group ? "" : check.group;
        group = check.group;
        text += padded(word_of(check.verdict.grade), word_width) + padded(shown, group_width) +
                padded(check.name, name_width);
        add_wrapped(text, check.verdict.found, found_at);
        if (check.verdict.remedy.empty())
            continue;
        text += "  -> ";
        add_wrapped(text, check.verdict.remedy, remedy_at);
    }
    return text + summary_of(diagnosis) + "\n";
}

program::Json json_of(const Diagnosis &diagnosis)
{
    program::Json checks = program::Json::array();
    for (const Check &check : diagnosis.checks) {
        const Verdict &verdict = check.verdict;
        checks.push_back(
            {{"group", check.group},
             {"check", check.name},
             {"verdict", verdict.grade == Grade::fail      ? "fail"
                         : verdict.grade == Grade::unknown ? "unknown"
                                                           : word_of(verdict.grade)},
             {"found", verdict.found},
             {"remedy", verdict.remedy.empty() ? program::Json() : program::Json(verdict.remedy)}});
    }
    return {{"settings", diagnosis.settings.file},
            {"map", diagnosis.settings.map},
            {"url", diagnosis.settings.url},
            {"failures", count_of(diagnosis, Grade::fail)},
            {"warnings", count_of(diagnosis, Grade::warn)},
            {"checks", checks}};
}

} // namespace vdna::doctor
