// vdna build - turns recorded traversals into the experience files of a map.
#include <algorithm>
#include <set>

#include "program/exit_code.hpp"
#include "program/interrupt.hpp"
#include "program/print.hpp"
#include "record/addition.hpp"
#include "record/maker.hpp"
#include "record/map_change.hpp"
#include "record/map_trust.hpp"
#include "vdna/commands.hpp"
#include "vdna/options.hpp"

namespace vdna::tool
{

namespace
{

namespace fs = std::filesystem;

struct BuildOptions {
    std::string map;
    std::vector<std::string> sources;
    NetworkOptions network;
    frames::SourceOptions source;
    uint32_t bins = 0; // 0 = those of the map, else the library's default
    std::string ranges;
    uint32_t range_rule = VDNA_RANGE_ABOUT_MIDPOINT;
    std::string name;
    bool join = false;
    bool force = false;
    bool no_thumbnails = false;
    bool no_trust = false;
    bool json = false;
};

// The name of the experience made from this folder or file; characters not allowed in names become
// '_'.
std::string name_of(const std::string &source)
{
    std::string name = frames::drive_name_of(source);
    vdna_name_replace(name.data());
    return name;
}

// The experiences to make. Refuses a name that is taken before any work.
std::vector<record::Draft> drafts_of(const BuildOptions &options)
{
    const std::vector<std::string> sources =
        options.join ? std::vector<std::string>{frames::join(options.sources)}
                     : frames::join_numbered(options.sources);
    if (!options.name.empty() && sources.size() > 1)
        throw program::UsageError("--name names one experience, but there are " +
                                  std::to_string(sources.size()) +
                                  " sources; if they are one drive, set --join");
    const auto is_folder = [](const std::string &source) { return fs::is_directory(source); };
    if (!options.source.labels.empty() && sources.size() > 1 &&
        !std::all_of(sources.begin(), sources.end(), is_folder))
        throw program::UsageError(
            "--labels numbers the frames of one video or log; build them one by one");
    std::vector<record::Draft> drafts;
    std::set<std::string> names;
    for (const std::string &source : sources) {
        record::Draft draft;
        draft.source = source;
        draft.name = options.name.empty() ? name_of(source) : options.name;
        record::require_name(draft.name, source);
        if (!names.insert(draft.name).second)
            throw program::UsageError(
                source + ": another source also becomes the experience " + draft.name +
                "; build them one by one with --name, or set --join if they are one "
                "drive");
        if (fs::exists(record::file_of(options.map, draft)) && !options.force)
            throw Error(record::file_of(options.map, draft).string() +
                        ": exists already; replace it with --force, or "
                        "choose another --name");
        drafts.push_back(std::move(draft));
    }
    return drafts;
}

void write(const std::vector<record::Draft> &drafts, const record::Maker &maker,
           record::MapChange &change)
{
    for (const record::Draft &draft : drafts) {
        program::require_not_interrupted();
        change.add(maker.experience_of(draft));
    }
    program::require_not_interrupted();
    change.commit();
}

void report(const BuildOptions &options, const std::vector<record::Draft> &drafts,
            const record::Maker &maker)
{
    for (const record::Draft &draft : drafts) {
        const fs::path file = record::file_of(options.map, draft);
        std::cout << file.string() << ": " << draft.recording.frames << " frames, "
                  << maker.blank().identity.neurons << " neurons x " << maker.bins() << " bins, "
                  << fs::file_size(file) << " bytes, "
                  << program::fixed(100 * draft.histogram->saturated_share(), 2)
                  << " % beyond the ranges";
        if (draft.recording.account.bad > 0)
            std::cout << ", " << draft.recording.account.bad << " bad frames left out";
        if (draft.recording.without_truth > 0)
            std::cout << ", " << draft.recording.without_truth << " without ground truth";
        std::cout << '\n';
    }
}

void report_json(const BuildOptions &options, const std::vector<record::Draft> &drafts,
                 const record::Maker &maker)
{
    const vdna_experience blank = maker.blank();
    program::Json experiences = program::Json::array();
    for (const record::Draft &draft : drafts) {
        const fs::path file = record::file_of(options.map, draft);
        program::Json json = {{"experience", draft.name},
                              {"file", file.string()},
                              {"source", draft.source},
                              {"frames", draft.recording.frames}};
        json.update(frames::json_of(draft.recording.account));
        json.update({{"frames_without_truth", draft.recording.without_truth},
                     {"neurons", blank.identity.neurons},
                     {"bins", maker.bins()},
                     {"bytes", fs::file_size(file)},
                     {"saturated_share", draft.histogram->saturated_share()}});
        experiences.push_back(json);
    }
    program::print_json({{"map", options.map},
                         {"backbone", blank.identity.backbone},
                         {"ranges", maker.ranges_origin()},
                         {"experiences", experiences}});
}

void build(const BuildOptions &options)
{
    std::vector<record::Draft> drafts = drafts_of(options);
    record::MapChange change(options.map);
    const record::Remaining remaining = record::remaining_in(options.map, drafts);
    Backbone backbone(record::backbone_of(options.network.backbone, remaining),
                      options.network.threads);
    record::Maker maker(backbone, options.source, record::bins_of(options.bins, remaining));
    record::find_ranges(options.ranges, remaining, backbone, maker);
    record::find_projection(options.ranges, remaining, backbone, maker);
    record::require_comparable(remaining, drafts, maker);
    if (!options.no_thumbnails)
        maker.add_thumbnails();
    maker.make(drafts, options.range_rule);
    record::require_one_frame(remaining, drafts);
    write(drafts, maker, change);
    if (!options.no_trust && remaining.members.size() + drafts.size() > 1)
        record::let_map_know_itself(options.map);
    for (const record::Draft &draft : drafts)
        tell(draft.source, draft.recording.account);
    options.json ? report_json(options, drafts, maker) : report(options, drafts, maker);
}

} // namespace

void add_build(CLI::App &app)
{
    CLI::App *command =
        app.add_subcommand("build", "Turn recorded traversals into the experience files of a map");
    const auto options = std::make_shared<BuildOptions>();
    command->add_option("MAP", options->map, "directory of the map; made if it does not exist")
        ->type_name("DIR")
        ->required();
    command
        ->add_option(
            "SOURCE", options->sources,
            "folder of pictures, video, LCM log or MCAP file; each becomes MAP/NAME.vdna. Files "
            "that a logger cut, drive.lcm.00 and drive.lcm.01, become one")
        ->type_name("PATH")
        ->required();
    add_network_options(*command, options->network,
                        std::string("that of the map, else ") + VDNA_BACKBONE_DEFAULT);
    add_source_options(*command, options->source);
    add_labels_option(*command, options->source);
    add_track_options(*command, options->source);
    command
        ->add_option("--name", options->name,
                     "name of the experience, for a single source (default: that of the source)")
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
    command->add_flag(
        "--join", options->join,
        "all SOURCEs are one drive, in this order: videos or logs that a recorder cut "
        "by size. Other sub-commands take such files as one SOURCE: a.mp4+b.mp4");
    command->add_flag("--no-thumbnails", options->no_thumbnails,
                      "leave out the thumbnails, a JPEG of at most " +
                          std::to_string(VDNA_THUMBNAIL_MAX) +
                          " bytes for each frame: see vdna show");
    add_no_trust_option(*command, options->no_trust);
    command->add_flag("--force", options->force, "replace existing experiences");
    command->add_flag("--json", options->json, "report as JSON");
    command->footer("All or nothing: after an error or Ctrl-C the map is unchanged. A map of two "
                    "experiences or more also gets MAP/" VDNA_MAP_TRUST_FILE
                    ", what it knows about "
                    "itself: see vdna calibrate --trust.\n\n"
                    "Examples:\n"
                    "  vdna build park winter/ summer/\n"
                    "  vdna build park --labels positions.csv --name autumn drive-7.mp4");
    command->callback([options] {
        options->source.label_options.of_several =
            options->sources.size() > 1 && !options->source.labels.empty();
        build(*options);
    });
}

} // namespace vdna::tool
