// vdna info - shows the contents of experience files and maps.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>

#include <vdna/cpp/error.hpp>

#include "program/notice.hpp"
#include "program/print.hpp"
#include "record/experiences.hpp"
#include "record/map_trust.hpp"
#include "vdna/commands.hpp"
#include "vdna/experience_table.hpp"
#include "vdna/position_json.hpp"

namespace vdna::tool
{

namespace
{

struct InfoOptions {
    std::vector<std::string> paths;
    bool in_full = false;
    bool json = false;
};

// Minimum and maximum of `count` numbers.
template <typename Number>
program::Json bounds_of(const Number *values, size_t count)
{
    const auto [lo, hi] = std::minmax_element(values, values + count);
    return {*lo, *hi};
}

// Which frames have no place, or no position if there are positions.
bool lacks_truth(const vdna_experience &e, size_t frame)
{
    if (e.frame_position)
        return std::isnan(e.frame_position[3 * frame]);
    return e.frame_place && e.frame_place[frame] == VDNA_PLACE_NONE;
}

uint32_t frames_without_truth(const vdna_experience &e)
{
    uint32_t count = 0;
    for (size_t i = 0; i < e.frames; i++)
        count += lacks_truth(e, i);
    return count;
}

// {"lat": [min, max], ...} or {"x": ...}, of the frames that have a position.
void add_positions(const vdna_experience &e, program::Json &labels)
{
    std::array<std::vector<double>, 3> numbers;
    for (size_t i = 0; i < e.frames; i++)
        if (!std::isnan(e.frame_position[3 * i])) {
            const std::array<double, 3> one =
                as_it_came(e.frame_position + 3 * i, e.position_frame);
            for (size_t axis = 0; axis < 3; axis++)
                numbers[axis].push_back(one[axis]);
        }
    labels["position_frame"] = e.position_frame;
    for (size_t axis = 0; axis < 3 && !numbers[0].empty(); axis++)
        labels[axes_of(e.position_frame)[axis]] =
            bounds_of(numbers[axis].data(), numbers[axis].size());
}

program::Json labels_of(const vdna_experience &e)
{
    program::Json labels = program::Json::object();
    std::vector<int64_t> places;
    for (size_t i = 0; e.frame_place && i < e.frames; i++)
        if (e.frame_place[i] != VDNA_PLACE_NONE)
            places.push_back(e.frame_place[i]);
    if (!places.empty())
        labels["place"] = bounds_of(places.data(), places.size());
    if (e.frame_position)
        add_positions(e, labels);
    if (const uint32_t without = frames_without_truth(e); without > 0)
        labels["frames_without_truth"] = without;
    return labels;
}

program::Json contents_of(const Experience &file)
{
    const vdna_experience &e = *file.get();
    const double grey = std::accumulate(e.frame_grey, e.frame_grey + e.frames, 0.0) / e.frames;
    return {{"file", file.path().string()},
            {"experience", e.name},
            {"bytes", e.file_size},
            {"frames", e.frames},
            {"order", e.order},
            {"utime", bounds_of(e.frame_utime, e.frames)},
            {"labels", labels_of(e)},
            {"mean_grey", grey},
            {"neurons", e.identity.neurons},
            {"bins", e.identity.bins},
            {"mass", bounds_of(e.mass, e.identity.neurons)},
            {"dim", e.identity.dim},
            {"backbone", e.identity.backbone},
            {"model_sha256", e.identity.model_sha256},
            {"precision", e.identity.precision},
            {"preprocessing", e.identity.preprocessing},
            {"taps", e.identity.taps},
            {"embedding", e.identity.embedding},
            {"raw_dim", e.identity.projection ? e.identity.raw_dim : e.identity.dim},
            {"storage", e.embedding_codes ? "int8" : "float32"},
            {"last_layer_dim", e.last_layer_dim},
            {"comparable", e.comparable}};
}

program::Json json_of(const Experience &file)
{
    program::Json json = contents_of(file);
    json.update(look_of(*file.get()));
    return json;
}

void print_text(const program::Json &json)
{
    for (const auto &[key, value] : json.items()) {
        const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
        std::cout << (key == "file" ? "" : "  ") << key << ": " << text << '\n';
    }
}

void print(const std::vector<Experience> &files, bool in_full)
{
    if (!in_full)
        std::cout << experience_table(files);
    for (const Experience &file : files)
        if (in_full)
            print_text(json_of(file));
}

// What belongs to the map as a whole, below the table of its experiences.
void print_map(const std::string &map, const vdna_experience &e, const program::Json &trust)
{
    std::cout << map << ": " << e.identity.neurons << " neurons x " << e.identity.bins
              << " bins, embeddings of " << e.identity.dim << " numbers, backbone "
              << e.identity.backbone << " (" << vdna_identity_precision(&e.identity) << ")\n"
              << map << ": " << trust["trust"].get<std::string>() << '\n';
}

// Why these experiences are no map: they do not compare, or one name is there twice; "" if they
// are.
std::string mismatch_of(const std::vector<Experience> &files)
{
    std::map<std::string, std::string> names;
    for (const Experience &file : files) {
        const std::string path = file.path().string();
        vdna_error error{};
        if (vdna_experience_compare(files.front().get(), file.get(), &error) != VDNA_OK)
            return path + ": does not compare with " + files.front().path().string() + ": " +
                   error.text + "; rebuild it with `vdna build --force`";
        const auto [first, is_new] = names.try_emplace(file->name, path);
        if (!is_new)
            return path + ": is called " + file->name + " like " + first->second +
                   ", expected another name; remove one of them, or rebuild it with --name";
    }
    return "";
}

// Why ground truth of these experiences does not compare, although they do; "" if it does.
std::string warning_of(const std::vector<Experience> &files)
{
    const Experience *first = nullptr;
    for (const Experience &file : files) {
        if (!file->frame_position)
            continue;
        if (!first)
            first = &file;
        if (std::strcmp(file->position_frame, (*first)->position_frame) != 0)
            return file.path().string() + ": not labelled alike: positions in frame " +
                   file->position_frame + ", those of " + first->path().string() + " in " +
                   (*first)->position_frame;
    }
    return "";
}

// What the map knows about itself.
program::Json trust_of(const std::string &map, const std::vector<Experience> &files)
{
    std::vector<vdna_experience> experiences;
    for (const Experience &file : files)
        experiences.push_back(*file.get()); // borrowed
    const record::SelfKnowledge self = record::self_knowledge_of(map, experiences);
    program::Json json = {{"map", map}, {"trust", self.sentence}, {"labelled", self.labelled}};
    json["skill"] = program::known(self.skill);
    json["tolerance"] = self.tolerance ? program::Json(*self.tolerance) : program::Json();
    return json;
}

void info(const InfoOptions &options)
{
    std::vector<std::string> mismatches, warnings;
    program::Json maps = program::Json::array();
    program::Json experiences = program::Json::array();
    for (const std::string &path : options.paths) {
        const std::vector<Experience> files = record::open_experiences({path});
        const bool is_map = std::filesystem::is_directory(path);
        for (const Experience &file : files)
            experiences.push_back(json_of(file));
        if (!options.json)
            print(files, options.in_full || !is_map);
        const std::string mismatch = mismatch_of(files);
        if (!mismatch.empty())
            mismatches.push_back(mismatch);
        else if (is_map)
            maps.push_back(trust_of(path, files));
        if (!options.json && is_map && mismatch.empty())
            print_map(path, *files.front().get(), maps.back());
        const std::string warning = warning_of(files);
        if (!warning.empty())
            warnings.push_back(warning);
    }
    if (options.json)
        program::print_json({{"experiences", experiences},
                             {"maps", maps},
                             {"mismatches", mismatches},
                             {"warnings", warnings}});
    for (const std::string &warning : warnings)
        program::tell_once(warning);
    if (!mismatches.empty())
        throw Error(mismatches.front());
}

} // namespace

void add_info(CLI::App &app)
{
    CLI::App *command =
        app.add_subcommand("info", "Show the contents of experience files and maps");
    const auto options = std::make_shared<InfoOptions>();
    command
        ->add_option("PATH", options->paths,
                     "experience files, or map directories; experiences of a map must also compare")
        ->type_name("PATH")
        ->required();
    command->add_flag("-l,--long", options->in_full,
                      "all that each experience of a map holds, as of single files");
    command->add_flag("--json", options->json, "report as JSON");
    command->footer("A map is shown as a table, a file in full: times in microseconds, [a, b] are "
                    "minimum and maximum.\n\n"
                    "Examples:\n"
                    "  vdna info park\n"
                    "  vdna info --json park/winter.vdna");
    command->callback([options] { info(*options); });
}

} // namespace vdna::tool
