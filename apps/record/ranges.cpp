#include "record/ranges.hpp"

#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

#include <vdna/cpp/error.hpp>
#include <vdna/cpp/experience.hpp>

#include "program/whole_file.hpp"

namespace vdna::record
{

namespace
{

using Json = nlohmann::ordered_json;

constexpr const char *format_name = "vdna-ranges";
constexpr int format_version = 1;

uint32_t neurons_of(const Ranges &ranges)
{
    return static_cast<uint32_t>(ranges.values.size() / 2);
}

Ranges from_experience(const std::string &path)
{
    const Experience file(path);
    const vdna_experience &e = *file.get();
    return {path,
            e.backbone,
            e.model_sha256,
            e.precision,
            e.preprocessing,
            e.taps,
            {e.range, e.range + size_t{2} * e.neurons}};
}

Ranges from_json(const std::string &path, const Json &json)
{
    if (json.at("format") != format_name || json.at("version") != format_version)
        throw Error(path + ": found format " + json.at("format").dump() + " version " +
                    json.at("version").dump() + ", expected \"vdna-ranges\" version 1");
    Ranges ranges{path,
                  json.at("backbone"),
                  json.at("model_sha256"),
                  json.value("precision", "fp32"),
                  json.at("preprocessing"),
                  json.at("taps"),
                  {}};
    for (const auto &[lo, hi] : json.at("range").get<std::vector<std::pair<float, float>>>())
        ranges.values.insert(ranges.values.end(), {lo, hi});
    if (vdna_range_check(ranges.values.data(), neurons_of(ranges)) != VDNA_OK)
        throw Error(path + ": a range is empty or not finite, expected lo < hi for each neuron");
    return ranges;
}

} // namespace

const char *const range_rules[2] = {"midpoint", "zero"};

Calibration::Calibration(const vdna_backbone_info &backbone)
    : observed_{"calibration",
                backbone.name,
                backbone.model_sha256,
                backbone.precision,
                backbone.preprocessing,
                backbone.taps,
                std::vector<float>(size_t{2} * backbone.neurons)}
{
    require(vdna_range_clear(observed_.values.data(), backbone.neurons), observed_.origin);
}

void Calibration::observe(const vdna_backbone_frame &frame, const std::string &where)
{
    require(vdna_range_observe(observed_.values.data(), neurons_of(observed_), frame.taps,
                               frame.tap_count),
            where);
}

Ranges Calibration::ranges(uint32_t rule) const
{
    Ranges expanded = observed_;
    require(
        vdna_range_expand(expanded.values.data(), neurons_of(expanded), VDNA_RANGE_FACTOR, rule),
        expanded.origin);
    return expanded;
}

Ranges read_ranges(const std::string &path)
{
    if (std::filesystem::path(path).extension() == VDNA_MAP_EXTENSION)
        return from_experience(path);
    std::ifstream stream(path, std::ios::binary);
    if (!stream)
        throw Error(path + ": cannot open, expected a ranges file of `vdna calibrate`");
    try {
        return from_json(path, Json::parse(stream));
    } catch (const Json::parse_error &e) {
        // Not its text, which repeats bytes of the file.
        throw Error(path + ": not JSON at byte " + std::to_string(e.byte) +
                    "; expected a ranges file of `vdna calibrate` or an experience file");
    } catch (const Json::exception &e) {
        throw Error(path +
                    ": not a ranges file of `vdna calibrate` or an experience file: " + e.what());
    }
}

void write_ranges(const Ranges &ranges, uint32_t rule, const std::string &path)
{
    Json pairs = Json::array();
    for (size_t i = 0; i < ranges.values.size(); i += 2)
        pairs.push_back({ranges.values[i], ranges.values[i + 1]});
    const Json json = {{"format", format_name},         {"version", format_version},
                       {"backbone", ranges.backbone},   {"model_sha256", ranges.model_sha256},
                       {"precision", ranges.precision}, {"preprocessing", ranges.preprocessing},
                       {"taps", ranges.taps},           {"factor", VDNA_RANGE_FACTOR},
                       {"rule", range_rules[rule]},     {"range", pairs}};
    program::write_whole_file(path, json.dump() + "\n");
}

void require_backbone(const Ranges &ranges, const vdna_backbone_info &backbone)
{
    const auto require_same = [&](const char *field, const std::string &found,
                                  const std::string &expected) {
        if (found != expected)
            throw Error(ranges.origin + ": " + field + " is " + found + " (backbone " +
                        ranges.backbone + "), expected " + expected + " of backbone " +
                        backbone.name + "; use the other backbone, or `vdna calibrate --backbone " +
                        backbone.name + "`");
    };
    // Where it is the reason that the models differ, it says more than their hashes.
    if (ranges.model_sha256 != backbone.model_sha256)
        require_same("precision", ranges.precision, backbone.precision);
    require_same("model_sha256", ranges.model_sha256, backbone.model_sha256);
    require_same("preprocessing", ranges.preprocessing, backbone.preprocessing);
    require_same("taps", ranges.taps, backbone.taps);
    require_same("number of neurons", std::to_string(neurons_of(ranges)),
                 std::to_string(backbone.neurons));
}

} // namespace vdna::record
