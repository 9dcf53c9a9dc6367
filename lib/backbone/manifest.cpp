#include "manifest.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include <toml++/toml.h>

#include <vdna/identity.h>

#include "failure.hpp"
#include "read_file.hpp"

namespace vdna::backbone
{

namespace
{

constexpr size_t file_max = 1 << 16;

using Keys = std::initializer_list<std::string_view>;

// In the order of picture::Interpolation.
const Keys interpolation_names = {"area", "linear", "cubic", "pillow_bicubic"};

std::string listed(Keys keys)
{
    std::string list;
    for (const auto key : keys)
        list += (list.empty() ? "" : ", ") + std::string(key);
    return list;
}

// Reads one manifest; the members are named after what they read.
class Reader
{
  public:
    explicit Reader(const std::filesystem::path &file) : file_(file) {}
    Manifest manifest(const toml::table &root) const;

    [[noreturn]] void refuse(const toml::source_region &where, const std::string &sentence) const
    {
        throw fail::Failure(VDNA_ERR_FORMAT, file_.string() + ":" +
                                                 std::to_string(where.begin.line) + ": " +
                                                 sentence);
    }

  private:
    Input input(const toml::table &table) const;
    std::vector<TappedOutput> taps(const toml::table &root) const;
    std::string precision(const toml::table &root) const;
    std::string quantised_from(const toml::table &root) const;
    Embedding embedding(const toml::table &table) const;
    void change_to_papers(const toml::table &table, Manifest &manifest) const;
    Grid grid(const toml::node &node) const;
    uint32_t dims(const toml::table &table) const;
    Golden golden(const toml::table &table, const Manifest &manifest) const;
    std::vector<double> part_means(const toml::node &node) const;

    void allow_only(const toml::table &table, Keys keys) const;
    const toml::node &need(const toml::table &table, std::string_view key,
                           const std::string &expected) const;
    const toml::table &section(const toml::table &root, std::string_view key) const;
    std::string text(const toml::table &table, std::string_view key) const;
    std::string plain_name(const toml::table &table, std::string_view key) const;
    std::string output(const toml::table &table) const;
    std::string word(const toml::table &table, std::string_view key) const;
    std::string hash(const toml::table &table, std::string_view key) const;
    size_t choice(const toml::table &table, std::string_view key, Keys choices) const;
    uint32_t side(const toml::table &table, std::string_view key) const;
    std::array<double, 3> channels(const toml::table &table, std::string_view key) const;
    bool flag(const toml::table &table, std::string_view key) const;

    std::filesystem::path file_;
};

void Reader::allow_only(const toml::table &table, Keys keys) const
{
    for (auto &&[key, value] : table)
        if (std::find(keys.begin(), keys.end(), key.str()) == keys.end())
            refuse(key.source(),
                   "unknown key '" + std::string(key.str()) + "'; expected: " + listed(keys));
}

const toml::node &Reader::need(const toml::table &table, std::string_view key,
                               const std::string &expected) const
{
    const toml::node *node = table.get(key);
    if (!node)
        refuse(table.source(), "'" + std::string(key) + "' is missing; expected " + expected);
    return *node;
}

const toml::table &Reader::section(const toml::table &root, std::string_view key) const
{
    const std::string expected = "a section [" + std::string(key) + "]";
    const toml::node &node = need(root, key, expected);
    if (!node.is_table())
        refuse(node.source(), "'" + std::string(key) + "' must be " + expected);
    return *node.as_table();
}

std::string Reader::text(const toml::table &table, std::string_view key) const
{
    const toml::node &node = need(table, key, "a text in quotes");
    if (!node.is_string() || node.as_string()->get().empty())
        refuse(node.source(), "'" + std::string(key) + "' must be a text in quotes, not empty");
    return node.as_string()->get();
}

std::string Reader::plain_name(const toml::table &table, std::string_view key) const
{
    const std::string name = text(table, key);
    // A NUL within the name would end it for the check.
    if (vdna_name_check(name.c_str(), nullptr) != VDNA_OK || name.find('\0') != std::string::npos)
        refuse(table.get(key)->source(), "'" + std::string(key) + "' must be 1 to " +
                                             std::to_string(VDNA_NAME_SIZE - 1) +
                                             " " VDNA_NAME_ALPHABET);
    return name;
}

std::string Reader::output(const toml::table &table) const
{
    const std::string name = text(table, "output");
    // They separate taps, and the fields of one, in the list of an identity.
    if (name.find_first_of(":,") != std::string::npos)
        refuse(table.get("output")->source(), "'output' must be a name without ':' and ','");
    return name;
}

// The name of an output as one word of an embedding's definition.
std::string Reader::word(const toml::table &table, std::string_view key) const
{
    const std::string name = text(table, key);
    if (name.find(' ') != std::string::npos)
        refuse(table.get(key)->source(),
               "'" + std::string(key) + "' must be a name without blanks");
    return name;
}

std::string Reader::hash(const toml::table &table, std::string_view key) const
{
    const std::string hash = text(table, key);
    if (hash.size() != 64 || hash.find_first_not_of("0123456789abcdef") != std::string::npos)
        refuse(table.get(key)->source(), "'" + std::string(key) +
                                             "' must be 64 lower-case hexadecimal digits, as "
                                             "`sha256sum` prints them");
    return hash;
}

size_t Reader::choice(const toml::table &table, std::string_view key, Keys choices) const
{
    const std::string chosen = text(table, key);
    const auto found = std::find(choices.begin(), choices.end(), chosen);
    if (found == choices.end())
        refuse(table.get(key)->source(),
               "'" + std::string(key) + "' is '" + chosen + "'; expected: " + listed(choices));
    return static_cast<size_t>(found - choices.begin());
}

uint32_t Reader::side(const toml::table &table, std::string_view key) const
{
    const std::string expected =
        "a whole number of pixels, 1 to " + std::to_string(Input::side_max);
    const toml::node &node = need(table, key, expected);
    const int64_t pixels = node.is_integer() ? node.as_integer()->get() : 0;
    if (pixels < 1 || pixels > Input::side_max)
        refuse(node.source(), "'" + std::string(key) + "' must be " + expected);
    return static_cast<uint32_t>(pixels);
}

std::array<double, 3> Reader::channels(const toml::table &table, std::string_view key) const
{
    const std::string expected = "three numbers in 0..255 units, one per channel";
    const toml::node &node = need(table, key, expected);
    const toml::array *list = node.as_array();
    std::array<double, 3> values{};
    for (size_t c = 0; c < values.size(); c++) {
        const toml::node *element = list && list->size() == values.size() ? list->get(c) : nullptr;
        const double value = element && element->is_number() ? element->value_or(double{NAN}) : NAN;
        if (!std::isfinite(value))
            refuse(node.source(), "'" + std::string(key) + "' must be " + expected);
        values[c] = value;
    }
    return values;
}

bool Reader::flag(const toml::table &table, std::string_view key) const
{
    const toml::node &node = need(table, key, "true or false");
    if (!node.is_boolean())
        refuse(node.source(), "'" + std::string(key) + "' must be true or false");
    return node.as_boolean()->get();
}

Input Reader::input(const toml::table &table) const
{
    allow_only(table, {"name", "width", "height", "colour", "mean", "std", "resize",
                       "interpolation", "decode"});
    Input input{};
    input.name = text(table, "name");
    input.width = side(table, "width");
    input.height = side(table, "height");
    input.bgr = choice(table, "colour", {"RGB", "BGR"}) == 1;
    input.mean = channels(table, "mean");
    input.std = channels(table, "std");
    if (*std::min_element(input.std.begin(), input.std.end()) <= 0.0)
        refuse(table.get("std")->source(), "'std' is divided by: its numbers must be above 0");
    choice(table, "resize", {"stretch"});
    input.interpolation =
        static_cast<picture::Interpolation>(choice(table, "interpolation", interpolation_names));
    input.reduced = table.contains("decode") && choice(table, "decode", {"full", "reduced"}) == 1;
    return input;
}

std::vector<TappedOutput> Reader::taps(const toml::table &root) const
{
    const toml::node &node = need(root, "taps", "at least one section [[taps]]");
    if (!node.is_array_of_tables())
        refuse(node.source(), "'taps' must be one or more sections [[taps]]");
    std::vector<TappedOutput> taps;
    for (const toml::node &element : *node.as_array()) {
        const toml::table &table = *element.as_table();
        allow_only(table, {"output", "layout"});
        const TappedOutput tap{
            output(table),
            static_cast<uint32_t>(choice(table, "layout", {"samples_neurons", "neurons_samples"}))};
        for (const TappedOutput &other : taps)
            if (other.output == tap.output)
                refuse(table.get("output")->source(), "'" + tap.output + "' is tapped twice");
        taps.push_back(tap);
    }
    return taps;
}

std::string Reader::precision(const toml::table &root) const
{
    if (!root.contains("precision"))
        return VDNA_PRECISION_DEFAULT;
    return choice(root, "precision", {"fp32", "int8"}) == 1 ? "int8" : "fp32";
}

std::string Reader::quantised_from(const toml::table &root) const
{
    if (!root.contains("quantised"))
        return "";
    const toml::table &table = section(root, "quantised");
    allow_only(table, {"from_sha256", "method"});
    text(table, "method"); // for people only
    return hash(table, "from_sha256");
}

Grid Reader::grid(const toml::node &node) const
{
    const auto cells = [](const toml::node *side) {
        const int64_t count = side && side->is_integer() ? side->as_integer()->get() : 0;
        return count >= 1 && count <= Input::side_max ? static_cast<uint32_t>(count) : 0;
    };
    const toml::array *list = node.as_array();
    const bool is_pair = list && list->size() == 2;
    const Grid grid =
        is_pair ? Grid{cells(list->get(0)), cells(list->get(1))} : Grid{cells(&node), cells(&node)};
    if (grid.rows == 0 || grid.columns == 0)
        refuse(node.source(), "'grid' must be a number of cells per side, 1 to " +
                                  std::to_string(Input::side_max) + ", or [rows, columns]");
    return grid;
}

uint32_t Reader::dims(const toml::table &table) const
{
    const toml::node *const node = table.get("dims");
    if (!node)
        return 0;
    const int64_t count = node->is_integer() ? node->as_integer()->get() : 0;
    if (count < 1 || count > UINT32_MAX)
        refuse(node->source(), "'dims' must be how many numbers of each embedding a map keeps, "
                               "from 1 to all of them");
    return static_cast<uint32_t>(count);
}

Embedding Reader::embedding(const toml::table &table) const
{
    allow_only(table,
               {"output", "grid", "dims", "centre", "last_layer", "l2_normalise", "storage"});
    Embedding embedding{};
    embedding.output = word(table, "output");
    if (const toml::node *const node = table.get("grid"))
        embedding.grid = grid(*node);
    embedding.dims = dims(table);
    embedding.centre = table.contains("centre") && flag(table, "centre");
    embedding.l2_normalise = flag(table, "l2_normalise");
    embedding.int8 =
        table.contains("storage") && choice(table, "storage", {"float32", "int8"}) == 1;
    if (table.contains("last_layer"))
        embedding.last_layer = word(table, "last_layer");
    return embedding;
}

// As in the paper, one layer serves both: frames are localised by the last one. Golden numbers of
// what they would be localised by otherwise say nothing then.
void Reader::change_to_papers(const toml::table &table, Manifest &manifest) const
{
    const Embedding ours = manifest.embedding;
    if (ours.grid && ours.last_layer.empty())
        refuse(table.source(), "protocol 'paper' localises by the last layer; name its output, "
                               "'last_layer = ...'");
    Embedding whole{};
    whole.output = ours.last_layer.empty() ? ours.output : ours.last_layer;
    whole.l2_normalise = ours.l2_normalise;
    whole.int8 = ours.int8;
    manifest.embedding = whole;
    if (manifest.golden)
        manifest.golden->embedding = manifest.golden->last_layer = {};
}

std::vector<double> Reader::part_means(const toml::node &node) const
{
    const toml::array *const list = node.as_array();
    std::vector<double> means;
    if (list && list->size() <= Golden::parts_max)
        for (const toml::node &element : *list)
            means.push_back(element.is_number() ? element.value_or(double{NAN}) : NAN);
    const auto finite = [](double mean) { return std::isfinite(mean); };
    if (means.empty() || !std::all_of(means.begin(), means.end(), finite))
        refuse(node.source(), "a list of 1 to " + std::to_string(Golden::parts_max) +
                                  " numbers was expected, as `vdna model golden` prints them");
    return means;
}

Golden Reader::golden(const toml::table &table, const Manifest &manifest) const
{
    allow_only(table, {"tolerance", "taps", "embedding", "last_layer"});
    Golden golden{};
    const std::string expected = "a number above 0 and below 1";
    const toml::node &tolerance = need(table, "tolerance", expected);
    golden.tolerance = tolerance.is_number() ? tolerance.value_or(0.0) : 0.0;
    if (!(golden.tolerance > 0 && golden.tolerance < 1))
        refuse(tolerance.source(), "'tolerance' must be " + expected);

    const std::string lists =
        std::to_string(manifest.taps.size()) + " lists, one for each [[taps]]";
    const toml::node &taps = need(table, "taps", lists);
    if (!taps.is_array() || taps.as_array()->size() != manifest.taps.size())
        refuse(taps.source(), "'taps' must be " + lists);
    for (const toml::node &tap : *taps.as_array())
        golden.taps.push_back(part_means(tap));
    golden.embedding = part_means(need(table, "embedding", "a list of numbers"));
    if (!manifest.embedding.last_layer.empty())
        golden.last_layer = part_means(need(table, "last_layer", "a list of numbers"));
    else if (table.contains("last_layer"))
        refuse(table.get("last_layer")->source(), "'last_layer' is not in [embedding]; remove it");
    return golden;
}

Manifest Reader::manifest(const toml::table &root) const
{
    allow_only(root, {"name", "model", "sha256", "source", "licence", "precision", "quantised",
                      "protocol", "input", "taps", "embedding", "golden"});
    Manifest manifest{};
    manifest.file = file_;
    manifest.name = plain_name(root, "name");
    manifest.model = file_.parent_path() / text(root, "model");
    manifest.sha256 = hash(root, "sha256");
    manifest.precision = precision(root);
    manifest.quantised_from = quantised_from(root);
    // For people only, yet a network without them is not one to ship.
    text(root, "source");
    text(root, "licence");
    manifest.input = input(section(root, "input"));
    manifest.taps = taps(root);

    const toml::table &localised_by = section(root, "embedding");
    manifest.embedding = embedding(localised_by);
    if (root.contains("golden"))
        manifest.golden = golden(section(root, "golden"), manifest);
    if (root.contains("protocol")) {
        choice(root, "protocol", {"paper"});
        change_to_papers(localised_by, manifest);
    }
    return manifest;
}

// The shortest text that reads back as the same number, whatever the locale.
std::string shortest(double value)
{
    char text[32];
    return std::string(text, std::to_chars(text, text + sizeof text, value).ptr);
}

std::string triple(const std::array<double, 3> &values)
{
    return shortest(values[0]) + "," + shortest(values[1]) + "," + shortest(values[2]);
}

} // namespace

Manifest read_manifest(const std::filesystem::path &file)
{
    const std::string bytes = read_file(file, file_max);
    const Reader reader(file);
    try {
        return reader.manifest(toml::parse(std::string_view(bytes)));
    } catch (const toml::parse_error &error) {
        reader.refuse(error.source(), std::string(error.description()));
    }
}

std::string preprocessing_text(const Manifest &manifest)
{
    const Input &input = manifest.input;
    return std::to_string(input.width) + "x" + std::to_string(input.height) +
           (input.bgr ? " BGR" : " RGB") + " mean=" + triple(input.mean) +
           " std=" + triple(input.std) + " resize=stretch/" +
           std::string(interpolation_names.begin()[static_cast<size_t>(input.interpolation)]) +
           (input.reduced ? " decode=reduced" : "") +
           " l2=" + (manifest.embedding.l2_normalise ? "1" : "0");
}

std::string embedding_text(const Embedding &embedding)
{
    if (!embedding.grid && !embedding.centre && embedding.last_layer.empty())
        return "";
    std::string text = embedding.output;
    if (embedding.grid)
        text += " grid=" + std::to_string(embedding.grid->rows) + "x" +
                std::to_string(embedding.grid->columns);
    if (!embedding.last_layer.empty())
        text += " last=" + embedding.last_layer;
    return text + (embedding.centre ? " centred" : "");
}

} // namespace vdna::backbone
