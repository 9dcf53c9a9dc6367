#include "record/ranges.hpp"

#include <cstring>
#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

#include <vdna/cpp/error.hpp>

#include "program/replaced_file.hpp"

namespace vdna::record
{

namespace
{

using Json = nlohmann::ordered_json;

constexpr const char *format_name = "vdna-ranges";
constexpr int format_version = 1;

// Ranges made with this network; its bins and its embedding do not matter.
Ranges ranges_of(const std::string &origin, const vdna_identity &identity,
                 std::vector<float> values)
{
    Ranges ranges{origin, identity, std::move(values)};
    ranges.identity.bins = ranges.identity.dim = 0;
    ranges.identity.range = nullptr;
    return ranges;
}

// Copy a text of a ranges file into a field of fixed size.
template <size_t Room>
void copy_text(const std::string &path, const char *key, const std::string &text, char (&out)[Room])
{
    if (text.size() >= Room)
        throw Error(path + ": " + key + " has " + std::to_string(text.size()) +
                    " characters, expected at most " + std::to_string(Room - 1));
    std::memcpy(out, text.c_str(), text.size() + 1);
}

Ranges from_json(const std::string &path, const Json &json)
{
    if (json.at("format") != format_name || json.at("version") != format_version)
        throw Error(path + ": found format " + json.at("format").dump() + " version " +
                    json.at("version").dump() + ", expected \"vdna-ranges\" version 1");
    Ranges ranges{path, {}, {}};
    vdna_identity &identity = ranges.identity;
    copy_text(path, "backbone", json.at("backbone"), identity.backbone);
    copy_text(path, "model_sha256", json.at("model_sha256"), identity.model_sha256);
    copy_text(path, "precision", json.value("precision", VDNA_PRECISION_DEFAULT),
              identity.precision);
    copy_text(path, "preprocessing", json.at("preprocessing"), identity.preprocessing);
    copy_text(path, "taps", json.at("taps"), identity.taps);
    for (const auto &[lo, hi] : json.at("range").get<std::vector<std::pair<float, float>>>())
        ranges.values.insert(ranges.values.end(), {lo, hi});
    identity.neurons = static_cast<uint32_t>(ranges.values.size() / 2);
    if (vdna_range_check(ranges.values.data(), identity.neurons) != VDNA_OK)
        throw Error(path + ": a range is empty or not finite, expected lo < hi for each neuron");
    return ranges;
}

// [neurons][2] as a list of pairs.
Json pairs_of(const std::vector<float> &values)
{
    Json pairs = Json::array();
    for (size_t i = 0; i < values.size(); i += 2)
        pairs.push_back({values[i], values[i + 1]});
    return pairs;
}

} // namespace

const char *const range_rules[2] = {"midpoint", "zero"};

Calibration::Calibration(const vdna_backbone_info &backbone)
    : observed_(ranges_of("calibration", backbone.identity,
                          std::vector<float>(size_t{2} * backbone.identity.neurons)))
{
    require(vdna_range_clear(observed_.values.data(), observed_.identity.neurons),
            observed_.origin);
}

void Calibration::observe(const vdna_backbone_frame &frame, const std::string &where)
{
    require(vdna_range_observe(observed_.values.data(), observed_.identity.neurons, frame.taps,
                               frame.tap_count),
            where);
}

Ranges Calibration::ranges(uint32_t rule) const
{
    Ranges expanded = observed_;
    expanded.observed = observed_.values;
    require(vdna_range_expand(expanded.values.data(), expanded.identity.neurons, VDNA_RANGE_FACTOR,
                              rule),
            expanded.origin);
    return expanded;
}

Ranges ranges_of(const Experience &experience)
{
    const vdna_identity &identity = experience->identity;
    return ranges_of(experience.path().string(), identity,
                     {identity.range, identity.range + size_t{2} * identity.neurons});
}

Ranges read_ranges(const std::string &path)
{
    if (std::filesystem::path(path).extension() == VDNA_MAP_EXTENSION)
        return ranges_of(Experience(path));
    std::ifstream stream(path, std::ios::binary);
    if (!stream)
        throw Error(path + ": cannot open, expected a ranges file of `vdna calibrate`");
    try {
        return from_json(path, Json::parse(stream));
    } catch (const Json::parse_error &e) {
        // The parser's message repeats bytes of the file, so leave it out.
        throw Error(path + ": not JSON at byte " + std::to_string(e.byte) +
                    "; expected a ranges file of `vdna calibrate` or an experience file");
    } catch (const Json::exception &e) {
        throw Error(path +
                    ": not a ranges file of `vdna calibrate` or an experience file: " + e.what());
    }
}

void write_ranges(const Ranges &ranges, uint32_t rule, const std::string &path)
{
    const vdna_identity &identity = ranges.identity;
    const Json json = {{"format", format_name},
                       {"version", format_version},
                       {"backbone", identity.backbone},
                       {"model_sha256", identity.model_sha256},
                       {"precision", vdna_identity_precision(&identity)},
                       {"preprocessing", identity.preprocessing},
                       {"taps", identity.taps},
                       {"factor", VDNA_RANGE_FACTOR},
                       {"rule", range_rules[rule]},
                       {"range", pairs_of(ranges.values)},
                       {"observed", pairs_of(ranges.observed)}};
    program::replace_file(path, json.dump() + "\n");
}

void require_backbone(const Ranges &ranges, const vdna_backbone_info &backbone)
{
    const std::string name = backbone.identity.backbone;
    vdna_error why{};
    if (vdna_identity_compare(&ranges.identity, &backbone.identity, &why) != VDNA_OK)
        throw Error(ranges.origin + ": these ranges (of backbone " + ranges.identity.backbone +
                    ") do not compare with backbone " + name + ": " + why.text +
                    "; use the other backbone, or `vdna calibrate --backbone " + name + "`");
}

} // namespace vdna::record
