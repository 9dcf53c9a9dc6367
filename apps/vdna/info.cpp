// vdna info - shows the contents of experience files and maps.
#include <algorithm>
#include <numeric>

#include <vdna/cpp/error.hpp>

#include "program/print.hpp"
#include "record/experiences.hpp"
#include "vdna/commands.hpp"

namespace vdna::tool
{

namespace
{

struct InfoOptions {
    std::vector<std::string> paths;
    bool json = false;
};

// Minimum and maximum of `count` numbers, `stride` apart.
template <typename Number>
program::Json bounds_of(const Number *values, size_t count, size_t stride = 1)
{
    Number lo = values[0], hi = values[0];
    for (size_t i = 0; i < count; i++) {
        lo = std::min(lo, values[i * stride]);
        hi = std::max(hi, values[i * stride]);
    }
    return {lo, hi};
}

program::Json labels_of(const vdna_experience &e)
{
    program::Json labels = program::Json::object();
    if (e.frame_place)
        labels["place"] = bounds_of(e.frame_place, e.frames);
    if (e.frame_position)
        for (size_t axis = 0; axis < 3; axis++)
            labels["position_m"].push_back(bounds_of(e.frame_position + axis, e.frames, 3));
    return labels;
}

program::Json json_of(const Experience &file)
{
    const vdna_experience &e = *file.get();
    const double grey = std::accumulate(e.frame_grey, e.frame_grey + e.frames, 0.0) / e.frames;
    return {{"file", file.path().string()},
            {"experience", e.name},
            {"bytes", e.file_size},
            {"frames", e.frames},
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
            {"comparable", e.comparable}};
}

void print_text(const program::Json &json)
{
    for (const auto &[key, value] : json.items()) {
        const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
        std::cout << (key == "file" ? "" : "  ") << key << ": " << text << '\n';
    }
}

// Why these experiences do not compare; "" if they do.
std::string mismatch_of(const std::vector<Experience> &files)
{
    for (const Experience &file : files) {
        vdna_error error{};
        if (vdna_experience_compare(files.front().get(), file.get(), &error) != VDNA_OK)
            return file.path().string() + ": does not compare with " +
                   files.front().path().string() + ": " + error.text;
    }
    return "";
}

void info(const InfoOptions &options)
{
    std::vector<std::string> mismatches;
    program::Json experiences = program::Json::array();
    for (const std::string &path : options.paths) {
        const std::vector<Experience> files = record::open_experiences({path});
        for (const Experience &file : files)
            experiences.push_back(json_of(file));
        const std::string mismatch = mismatch_of(files);
        if (!mismatch.empty())
            mismatches.push_back(mismatch);
    }
    if (options.json)
        program::print_json({{"experiences", experiences}, {"mismatches", mismatches}});
    else
        for (const program::Json &experience : experiences)
            print_text(experience);
    if (!mismatches.empty())
        throw Error(mismatches.front() + "; rebuild it with `vdna build --force`");
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
        ->type_name("")
        ->required();
    command->add_flag("--json", options->json, "report as JSON");
    command->footer("Times are in microseconds; [a, b] are minimum and maximum.\n\n"
                    "Examples:\n"
                    "  vdna info park\n"
                    "  vdna info --json park/winter.vdna");
    command->callback([options] { info(*options); });
}

} // namespace vdna::tool
