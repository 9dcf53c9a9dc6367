// vdna build - turn recorded traversals into the experience files of a map.
#include <algorithm>
#include <cstring>
#include <set>

#include <vdna/cpp/histogram.hpp>

#include "program/exit_code.hpp"
#include "program/interrupt.hpp"
#include "program/print.hpp"
#include "program/staged_files.hpp"
#include "record/activation_store.hpp"
#include "record/experiences.hpp"
#include "record/ranges.hpp"
#include "record/recording.hpp"
#include "vdna/commands.hpp"
#include "vdna/options.hpp"

namespace vdna::tool
{

namespace
{

namespace fs = std::filesystem;

// So much memory may be spent on not running the network twice.
constexpr size_t activation_bytes_max = size_t{512} << 20;

struct BuildOptions {
    std::string map;
    std::vector<std::string> sources;
    NetworkOptions network;
    frames::SourceOptions source;
    uint32_t bins = 0; // 0 = those of the map, else the library's default
    std::string ranges;
    uint32_t range_rule = VDNA_RANGE_ABOUT_MIDPOINT;
    std::string name;
    bool force = false;
    bool json = false;
};

// One experience in the making.
struct Draft {
    std::string source;
    std::string name;
    fs::path file;
    record::Recording recording;
    std::optional<Histogram> histogram; // once the ranges are known
};

// The name of an experience made from this folder or file: characters that names may not have
// become '_'.
std::string name_of(const std::string &source)
{
    const fs::path path = fs::weakly_canonical(source);
    std::string name = (fs::is_directory(path) ? path.filename() : path.stem()).string();
    vdna_name_replace(name.data());
    return name;
}

void require_name(const std::string &name, const std::string &source)
{
    if (vdna_name_check(name.c_str(), nullptr) != VDNA_OK || name[0] == '.')
        throw program::UsageError(source + ": cannot be the experience '" + name + "', expected 1 to " +
                        std::to_string(VDNA_NAME_SIZE - 1) +
                        " " VDNA_NAME_ALPHABET " and no '.' first; set --name");
}

// What is to be made, refused before any work if a name is taken.
std::vector<Draft> drafts_of(const BuildOptions &options)
{
    if (!options.name.empty() && options.sources.size() > 1)
        throw program::UsageError("--name names one experience, but there are " +
                                  std::to_string(options.sources.size()) + " sources");
    const auto is_folder = [](const std::string &source) { return fs::is_directory(source); };
    if (!options.source.labels.empty() && options.sources.size() > 1 &&
        !std::all_of(options.sources.begin(), options.sources.end(), is_folder))
        throw program::UsageError(
            "--labels numbers the frames of one video or log; build them one by one");
    std::vector<Draft> drafts;
    std::set<std::string> names;
    for (const std::string &source : options.sources) {
        Draft draft;
        draft.source = source;
        draft.name = options.name.empty() ? name_of(source) : options.name;
        require_name(draft.name, source);
        draft.file = fs::path(options.map) / (draft.name + VDNA_MAP_EXTENSION);
        if (!names.insert(draft.name).second)
            throw program::UsageError(source + ": another source also becomes the experience " +
                                      draft.name + "; build them one by one with --name");
        if (fs::exists(draft.file) && !options.force)
            throw Error(draft.file.string() + ": exists already; replace it with --force, or "
                                              "choose another --name");
        drafts.push_back(std::move(draft));
    }
    return drafts;
}

// The experiences of the map that will still be there afterwards.
std::vector<Experience> remaining_of(const BuildOptions &options, const std::vector<Draft> &drafts)
{
    std::vector<Experience> remaining;
    if (!fs::exists(options.map))
        return remaining;
    for (const fs::path &file : record::experience_files(options.map)) {
        const auto replaced = [&](const Draft &draft) { return draft.file == file; };
        if (std::none_of(drafts.begin(), drafts.end(), replaced))
            remaining.emplace_back(file);
    }
    return remaining;
}

// One run of the sub-command.
class Build
{
  public:
    explicit Build(const BuildOptions &options)
        : options_(options), drafts_(drafts_of(options)),
          remaining_(remaining_of(options, drafts_)),
          backbone_(backbone_name(), options.network.threads), store_(activation_bytes_max)
    {
        bins_ = options.bins != 0    ? options.bins
                : remaining_.empty() ? VDNA_HIST_BINS_DEFAULT
                                     : remaining_.front()->identity.bins;
    }

    void run()
    {
        if (find_ranges())
            record_and_count();
        else
            calibrate_and_count();
        write();
        options_.json ? report_json() : report();
    }

  private:
    std::string backbone_name() const
    {
        if (!options_.network.backbone.empty())
            return options_.network.backbone;
        return remaining_.empty() ? default_backbone : remaining_.front()->identity.backbone;
    }

    // Take the ranges that were given or that the map has; false if there are none.
    bool find_ranges()
    {
        if (options_.ranges.empty() && remaining_.empty())
            return false;
        ranges_ = record::read_ranges(options_.ranges.empty() ? remaining_.front().path().string()
                                                              : options_.ranges);
        if (!options_.ranges.empty())
            record::require_backbone(ranges_, backbone_.info());
        require_comparable();
        return true;
    }

    // What will be made must compare with what is there: better said before the work than after.
    void require_comparable() const
    {
        const vdna_experience probe = blank();
        for (const Experience &there : remaining_) {
            vdna_error error{};
            if (vdna_experience_compare(there.get(), &probe, &error) != VDNA_OK)
                throw Error(there.path().string() +
                            ": does not compare with what is to be built: " + error.text +
                            "; use the map's backbone, bins and ranges, or rebuild all of its "
                            "experiences with --force");
            for (const Draft &draft : drafts_)
                if (draft.name == there->name)
                    throw Error(there.path().string() + ": is already called " + draft.name +
                                "; choose another --name");
        }
    }

    // Everything of an experience that does not depend on its frames.
    vdna_experience blank() const
    {
        vdna_experience e{};
        e.identity = backbone_.info().identity;
        e.identity.bins = bins_;
        e.identity.range = ranges_.values.data();
        return e;
    }

    void record_and_count()
    {
        for (Draft &draft : drafts_) {
            draft.histogram.emplace(ranges_.values, bins_);
            record::Pass pass(draft.source, options_.source, backbone_);
            while (pass.next()) {
                draft.recording.add(pass);
                count(draft, pass);
            }
            require_frames(draft, pass);
        }
    }

    void calibrate_and_count()
    {
        record::Calibration calibration(backbone_.info());
        for (Draft &draft : drafts_) {
            record::Pass pass(draft.source, options_.source, backbone_);
            while (pass.next()) {
                draft.recording.add(pass);
                calibration.observe(pass.output(), pass.frame().name);
                store_.add(pass.output());
            }
            require_frames(draft, pass);
        }
        ranges_ = calibration.ranges(options_.range_rule);
        for (Draft &draft : drafts_)
            draft.histogram.emplace(ranges_.values, bins_);
        store_.complete() ? count_stored() : count_again();
    }

    void count(Draft &draft, const record::Pass &pass) const
    {
        draft.histogram->add(pass.output().taps, pass.output().tap_count, pass.frame().name);
    }

    void count_stored()
    {
        size_t next = 0;
        for (Draft &draft : drafts_)
            for (uint32_t i = 0; i < draft.recording.frames; i++) {
                const std::vector<vdna_activations> taps = store_.taps(next++);
                draft.histogram->add(taps.data(), taps.size(), draft.source);
            }
    }

    // The second pass over the network, where there are too many activations to keep.
    void count_again()
    {
        for (Draft &draft : drafts_) {
            for (record::Pass pass(draft.source, options_.source, backbone_); pass.next();)
                count(draft, pass);
            if ((*draft.histogram)->frames != draft.recording.frames)
                throw Error(draft.source + ": changed while it was read");
        }
    }

    static void require_frames(Draft &draft, const record::Pass &pass)
    {
        draft.recording.bad = pass.bad();
        if (draft.recording.frames == 0)
            throw Error(draft.source + ": none of its " + std::to_string(pass.bad()) +
                        " frames can be used");
    }

    void write()
    {
        program::StagedFiles staged(options_.map);
        for (const Draft &draft : drafts_) {
            program::require_not_interrupted();
            staged.write(experience_of(draft), draft.file);
        }
        program::require_not_interrupted();
        staged.commit();
    }

    vdna_experience experience_of(const Draft &draft) const
    {
        const record::Recording &r = draft.recording;
        const Histogram &histogram = *draft.histogram;
        vdna_experience e = blank();
        std::memcpy(e.name, draft.name.c_str(), draft.name.size() + 1); // require_name() passed
        e.frames = r.frames;
        e.counts = histogram->counts;
        e.mass = histogram->mass;
        e.embeddings = r.embeddings.data();
        e.frame_utime = r.utime.data();
        e.frame_place = r.place.empty() ? nullptr : r.place.data();
        e.frame_position = r.position.empty() ? nullptr : r.position.data();
        e.frame_grey = r.grey.data();
        return e;
    }

    void report() const
    {
        for (const Draft &draft : drafts_) {
            std::cout << draft.file.string() << ": " << draft.recording.frames << " frames, "
                      << backbone_.info().identity.neurons << " neurons x " << bins_ << " bins, "
                      << fs::file_size(draft.file) << " bytes, "
                      << program::fixed(100 * draft.histogram->saturated_share(), 2)
                      << " % beyond the ranges";
            if (draft.recording.bad > 0)
                std::cout << ", " << draft.recording.bad << " bad frames left out";
            std::cout << '\n';
        }
    }

    void report_json() const
    {
        program::Json experiences = program::Json::array();
        for (const Draft &draft : drafts_)
            experiences.push_back({{"experience", draft.name},
                                   {"file", draft.file.string()},
                                   {"source", draft.source},
                                   {"frames", draft.recording.frames},
                                   {"bad_frames", draft.recording.bad},
                                   {"neurons", backbone_.info().identity.neurons},
                                   {"bins", bins_},
                                   {"bytes", fs::file_size(draft.file)},
                                   {"saturated_share", draft.histogram->saturated_share()}});
        program::print_json({{"map", options_.map},
                    {"backbone", backbone_.info().identity.backbone},
                    {"ranges", ranges_.origin},
                    {"experiences", experiences}});
    }

    const BuildOptions &options_;
    std::vector<Draft> drafts_;
    std::vector<Experience> remaining_;
    Backbone backbone_;
    record::ActivationStore store_;
    record::Ranges ranges_;
    uint32_t bins_;
};

} // namespace

void add_build(CLI::App &app)
{
    CLI::App *command =
        app.add_subcommand("build", "Turn recorded traversals into the experience files of a map");
    const auto options = std::make_shared<BuildOptions>();
    command->add_option("MAP", options->map, "directory of the map; made if it does not exist")
        ->type_name("")
        ->required();
    command
        ->add_option("SOURCE", options->sources,
                     "folder of pictures, video file or LCM log; each becomes MAP/NAME.vdna")
        ->type_name("")
        ->required();
    add_network_options(*command, options->network,
                        std::string("that of the map, else ") + default_backbone);
    add_source_options(*command, options->source);
    add_labels_option(*command, options->source);
    command
        ->add_option("--name", options->name,
                     "name of the experience, for one source (default: that of the source)")
        ->type_name("NAME");
    command
        ->add_option("--bins", options->bins,
                     "bins per neuron (default: those of the map, else 1000)")
        ->check(CLI::Range(VDNA_HIST_BINS_MIN, VDNA_HIST_BINS_MAX).description(""))
        ->type_name("2..65536");
    command
        ->add_option("--ranges", options->ranges,
                     "ranges file of `vdna calibrate`, or an experience file (default: the "
                     "map's ranges, else calibrated from the sources)")
        ->type_name("FILE");
    add_range_rule_option(*command, options->range_rule);
    command->add_flag("--force", options->force, "replace experiences that exist already");
    command->add_flag("--json", options->json, "report as JSON");
    command->footer("All or nothing: after an error or Ctrl-C the map is as it was.\n\n"
                    "Examples:\n"
                    "  vdna build park winter/ summer/\n"
                    "  vdna build park --labels positions.csv --name autumn drive-7.mp4");
    command->callback([options] { Build(*options).run(); });
}

} // namespace vdna::tool
