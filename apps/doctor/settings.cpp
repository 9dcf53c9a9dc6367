#include "doctor/settings.hpp"

#include <cstdlib>
#include <filesystem>
#include <sstream>

#include <nlohmann/json.hpp>
#include <toml++/toml.h>
#include <unistd.h>

#include <vdna/cpp/error.hpp>

#include "backbone/beside_program.hpp"
#include "doctor/child.hpp"
#include "doctor/system_files.hpp"

namespace vdna::doctor
{

namespace
{

std::string find_daemon()
{
    for (const std::filesystem::path &path : {backbone::beside_program("vdna_selectord"),
                                              backbone::beside_program("../sbin/vdna_selectord"),
                                              std::filesystem::path("/usr/sbin/vdna_selectord")})
        if (!path.empty() && access(path.c_str(), X_OK) == 0)
            return path;
    return "";
}

std::vector<std::string> arguments_of(const Named &named, const std::string &file)
{
    std::vector<std::string> arguments;
    const auto add = [&](const char *option, const std::string &value) {
        if (!value.empty())
            arguments.insert(arguments.end(), {option, value});
    };
    add("-c", file);
    add("--map", named.map);
    add("-l", named.url);
    return arguments;
}

// The last line on standard error, without the program's name.
std::string sentence_of(const Ended &ended)
{
    constexpr const char *name = "vdna_selectord: ";
    std::string text = ended.errors.substr(0, ended.errors.find_last_not_of('\n') + 1);
    text = text.substr(text.rfind('\n') + 1);
    if (text.rfind(name, 0) == 0)
        text = text.substr(std::string(name).size());
    return text.empty() ? "it ended with exit code " + std::to_string(ended.code) : text;
}

template <typename T>
void take(const toml::table &root, const char *section, const char *key, T &out)
{
    out = root[section][key].value<T>().value_or(out);
}

void take_all(const toml::table &root, Settings &settings)
{
    take(root, "map", "directory", settings.map);
    take(root, "backbone", "manifest", settings.manifest);
    take(root, "backbone", "runtime", settings.runtime);
    take(root, "backbone", "threads", settings.threads);
    take(root, "lcm", "url", settings.url);
    take(root, "lcm", "camera", settings.camera);
    take(root, "lcm", "status", settings.status);
    take(root, "lcm", "require_protection", settings.require_protection);
    take(root, "lcm", "max_image_bytes", settings.max_image_bytes);
    take(root, "memory", "lock", settings.lock_memory);
    take(root, "memory", "budget_mb", settings.budget_mb);
    take(root, "cpu", "affinity", settings.affinity);
    std::string list;
    take(root, "lcm", "sources", list);
    std::istringstream parts(list);
    for (std::string part; std::getline(parts, part, ',');)
        settings.sources.push_back(part);
}

// As LCM has it.
std::string url_or_default(const std::string &url)
{
    const char *everywhere = std::getenv("LCM_DEFAULT_URL");
    if (!url.empty())
        return url;
    return everywhere && *everywhere ? everywhere : VDNA_LCM_URL;
}

} // namespace

Settings read_settings(const Named &named, Trial &out_trial)
{
    Settings settings;
    settings.file = named.file;
    if (named.file.empty() && access(packaged_settings, F_OK) == 0)
        settings.file = packaged_settings;
    settings.map = named.map.empty() ? settings.map : named.map;
    settings.url = named.url;
    out_trial.program = find_daemon();
    if (!out_trial.program.empty()) {
        out_trial.version =
            value_of(run_program(out_trial.program, {"--version"}).out, "vdna_selectord");
        std::vector<std::string> arguments = arguments_of(named, settings.file);
        arguments.emplace_back("--print-config");
        const Ended printed = run_program(out_trial.program, arguments);
        if (printed.code == 0)
            take_all(toml::parse(printed.out), settings);
        else
            out_trial.refusal = sentence_of(printed);
    }
    settings.url = url_or_default(settings.url);
    return settings;
}

void try_start(const Named &named, const Settings &settings, Trial &trial)
{
    if (trial.program.empty() || !trial.refusal.empty())
        return;
    std::vector<std::string> arguments = arguments_of(named, settings.file);
    arguments.insert(arguments.end(), {"--print-memory", "--json"});
    const Ended ended = run_program(trial.program, arguments);
    if (ended.code != 0)
        trial.failure = sentence_of(ended);
    else if (const auto memory = nlohmann::json::parse(ended.out, nullptr, false);
             memory.is_object())
        trial.held_bytes = memory.value("held_bytes_max", uint64_t{0});
}

Verdict check_settings(const Settings &settings, const Trial &trial)
{
    if (!trial.refusal.empty())
        return failed(trial.refusal);
    if (trial.program.empty() && !settings.file.empty())
        return warn(settings.file + " is not read: vdna_selectord is not installed",
                    "install the package vdna-selectord, or build all programs");
    if (settings.file.empty())
        return ok("the defaults; -c names a file");
    return ok(settings.file + " is valid");
}

Verdict check_start(const Trial &trial, const std::string &known, const std::string &own)
{
    if (trial.program.empty())
        return unknown("vdna_selectord is not installed here");
    if (!trial.refusal.empty())
        return unknown("not tried: see settings");
    if (!trial.failure.empty() && trial.failure == known)
        return broken("vdna_selectord would not start: see map", "mend that first");
    if (!trial.failure.empty())
        return failed(trial.failure);
    if (trial.version != own)
        return warn("vdna_selectord is " + trial.version + ", vdna is " + own,
                    "install both from one release");
    return ok("vdna_selectord " + trial.version + " would start");
}

} // namespace vdna::doctor
