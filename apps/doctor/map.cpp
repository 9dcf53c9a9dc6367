#include "doctor/map.hpp"

#include <algorithm>
#include <cstring>
#include <optional>

#include <vdna/cpp/backbone.hpp>
#include <vdna/cpp/map.hpp>
#include <vdna/cpp/trust.hpp>

#include "record/map_trust.hpp"
#include "telemetry/headline.hpp"

namespace vdna::doctor
{

namespace
{

void describe(const Map &map, MapFacts &facts)
{
    facts.left_out = map.left_out();
    facts.experiences = map.experiences().size();
    facts.hash = map.hash();
    for (const vdna_experience &experience : map.experiences()) {
        facts.frames += experience.frames;
        facts.largest_bytes = std::max(facts.largest_bytes, uint64_t{experience.file_size});
    }
    facts.trust = record::self_knowledge_of(map.directory(), map.experiences()).sentence;
    facts.no_prediction = Trust(map).why_no_predictions();
}

void describe(const vdna_backbone_info &info, MapFacts &facts)
{
    facts.network = info.identity.backbone;
    facts.sha256 = info.identity.model_sha256;
    facts.precision = vdna_identity_precision(&info.identity);
    facts.runtime = info.runtime;
}

// What an action throws as an Error; "" if nothing.
template <typename Action>
std::string error_of(Action action)
{
    try {
        action();
        return "";
    } catch (const Error &error) {
        return error.what();
    }
}

std::string text_of(const program::Json &json, const char *name)
{
    return json.contains(name) && json[name].is_string() ? json[name].get<std::string>() : "";
}

std::string hash_text(const std::string &hash)
{
    return hash.substr(0, 8);
}

// What is wrong with the map that a daemon of this machine serves; nothing if it is ours.
std::optional<Verdict> other_map(const Settings &settings, const MapFacts &map,
                                 const program::Json &status)
{
    const std::string hash = text_of(status, "map_hash");
    const bool is_changed = status.value("map_changed", false);
    if (!map.refusal.empty() || (hash == map.hash && !is_changed))
        return {};
    return broken("the daemon serves another map, " + hash_text(hash) + ", than " + settings.map +
                      " has, " + hash_text(map.hash),
                  "sudo systemctl reload vdna_selectord (SIGHUP opens the map again)");
}

} // namespace

MapFacts examine_map(const Settings &settings)
{
    MapFacts facts;
    std::optional<Map> map;
    facts.refusal = error_of([&] { map.emplace(settings.map, MapOpening{false, true}); });
    if (map)
        describe(*map, facts);
    std::optional<Backbone> backbone;
    facts.network_refusal =
        error_of([&] { backbone.emplace(settings.manifest, settings.threads, settings.runtime); });
    if (backbone)
        describe(backbone->info(), facts);
    if (map && backbone)
        facts.mismatch = error_of([&] { map->require_backbone(backbone->info()); });
    return facts;
}

Verdict check_files(const Settings &settings, const MapFacts &map)
{
    if (!map.refusal.empty())
        return failed(map.refusal);
    if (!map.left_out.empty())
        return warned(map.left_out.front() +
                      (map.left_out.size() > 1
                           ? "; " + std::to_string(map.left_out.size() - 1) + " more are damaged"
                           : ""));
    return ok(settings.map + ": " + std::to_string(map.experiences) + " experiences, " +
              std::to_string(map.frames) + " frames, hash " + hash_text(map.hash));
}

Verdict check_network(const MapFacts &map)
{
    if (!map.network_refusal.empty())
        return failed(map.network_refusal);
    if (!map.mismatch.empty())
        return failed(map.mismatch);
    const std::string name =
        map.network + " " + map.precision + ", sha256 " + hash_text(map.sha256);
    return ok(name + (map.refusal.empty() ? ", is the map's" : ", opens"));
}

Verdict check_trust(const MapFacts &map)
{
    if (!map.refusal.empty())
        return unknown("no map: see files");
    if (!map.no_prediction.empty())
        return warned("no predicted recall: " + map.no_prediction);
    return ok(map.trust);
}

Verdict check_daemon(const Settings &settings, const MapFacts &map, const Heard &heard,
                     const std::string &own, const std::string &host)
{
    const program::Json &status = heard.status;
    if (!status.is_object())
        return unknown("none heard on " + settings.status);
    const std::string where = text_of(status, "host"), version = text_of(status, "version");
    if (version != own)
        return broken("the daemon on " + where + " is version " + version + ", this is " + own,
                      "sudo systemctl restart vdna_selectord, or install the same on both");
    if (where == host)
        if (const std::optional<Verdict> verdict = other_map(settings, map, status))
            return *verdict;
    const telemetry::Headline line = telemetry::headline(status, nullptr, 0, settings.url);
    if (std::strcmp(line.tone, "bad") == 0)
        return broken(line.text, "see docs/operating/no-answers.md, and the checks above");
    if (std::strcmp(line.tone, "doubt") == 0)
        return warn(line.text, "see docs/operating/no-answers.md, and the checks above");
    return ok(version + " on " + where + ", " +
              (where == host ? "same map: " : "a machine of its own: ") + text_of(status, "state"));
}

} // namespace vdna::doctor
