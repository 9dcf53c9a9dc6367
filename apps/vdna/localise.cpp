// vdna localise - localises live frames in the experiences of a map and reports Recall@1.
#include <cmath>
#include <iomanip>

#include <vdna/cpp/map.hpp>
#include <vdna/localise.h>

#include "program/decimal.hpp"
#include "program/print.hpp"
#include "record/candidates.hpp"
#include "record/localisation.hpp"
#include "record/projection.hpp"
#include "report/difference_matrix.hpp"
#include "vdna/commands.hpp"
#include "vdna/options.hpp"
#include "vdna/position_json.hpp"

namespace vdna::tool
{

namespace
{

struct LocaliseOptions {
    std::string live;
    std::string map;
    NetworkOptions network;
    frames::SourceOptions source;
    uint32_t warmup_frames = 0;
    std::vector<std::string> in;
    std::string localiser = "filter";
    double min_confidence = VDNA_LOCALISE_MIN_CONFIDENCE_DEFAULT;
    double tolerance = 5;
    bool with_altitude = false;
    std::string matrix;
    bool matches = false;
    bool json = false;

    bool with_filter() const { return localiser == "filter"; }
};

struct Drive {
    record::Recording warmup, live;
};

Drive record(const LocaliseOptions &options, const Map &map)
{
    const NetworkOptions &network = options.network;
    Backbone backbone(network.backbone.empty() ? map.experiences().front().identity.backbone
                                               : network.backbone,
                      network.threads);
    map.require_backbone(backbone.info());
    Drive drive;
    record::Pass pass(options.live, options.source, backbone);
    while (pass.next())
        (drive.warmup.frames < options.warmup_frames ? drive.warmup : drive.live).add(pass);
    record::project(drive.warmup, map.experiences().front().identity);
    record::project(drive.live, map.experiences().front().identity);
    drive.live.account = pass.account();
    if (drive.live.frames == 0 && drive.warmup.frames > 0)
        throw Error(options.live + ": has " + std::to_string(drive.warmup.frames) +
                    " frames, expected more than the " + std::to_string(options.warmup_frames) +
                    " of the warmup; set --skip");
    drive.live.require_frames(options.live);
    tell(options.live, drive.live.account);
    return drive;
}

std::vector<const vdna_experience *> picked_from(const Map &map,
                                                 const std::vector<std::string> &names)
{
    std::vector<const vdna_experience *> picked;
    for (const size_t i : names.empty() ? record::all_but(map, {}) : record::named_in(map, names))
        picked.push_back(&map.experiences()[i]);
    return picked;
}

// The answers of one experience, or of all together.
struct Answers {
    record::Localisation told;    // by the filter, or without it the nearest
    record::Localisation nearest; // each frame by itself
};

void report_line(const LocaliseOptions &options, const Answers &answers, int width)
{
    const record::Localisation &told = answers.told;
    const auto percent = [](bool is_known, double value) {
        return is_known ? program::fixed(value, 2) : "-";
    };
    const bool is_judged = told.judged() > 0;
    const auto count = [&](uint32_t frames) { return is_judged ? std::to_string(frames) : "-"; };
    std::cout << std::left << std::setw(width) << told.experience << std::right << std::setw(10)
              << percent(is_judged, told.recall_percent()) << std::setw(11)
              << percent(is_judged, answers.nearest.recall_percent()) << std::setw(10)
              << percent(options.with_filter(), told.unsure_percent(options.min_confidence))
              << std::setw(10) << count(told.good()) << std::setw(13) << count(told.unreachable());
    if (!is_judged)
        std::cout << "  not labelled alike" << (told.difference.empty() ? "" : ": ")
                  << told.difference;
    if (told.lost_after > 0)
        std::cout << "  another route, by its jumps after " << told.lost_after << " frames";
    std::cout << '\n';
}

void report(const LocaliseOptions &options, const Drive &drive, const std::vector<Answers> &results,
            const Answers &all)
{
    const record::Recording &live = drive.live;
    size_t width = std::string("experience").size();
    for (const Answers &answers : results)
        width = std::max(width, answers.told.experience.size());
    std::cout << options.live << ": " << live.frames << " frames";
    if (drive.warmup.frames > 0)
        std::cout << " after " << drive.warmup.frames << " of warmup";
    if (live.account.bad > 0)
        std::cout << ", " << live.account.bad << " bad ones left out";
    const record::Localisation &first = results.front().told;
    if (const size_t unknown = live.frames - first.judged(); first.judged() > 0 && unknown > 0)
        std::cout << ", " << unknown << " without ground truth left out of the recall";
    if (first.judged() > 0)
        std::cout << ", tolerance " << options.tolerance << ' ' << name_of(first.unit)
                  << (options.with_altitude ? " with altitude" : "");
    std::cout << '\n'
              << std::left << std::setw(static_cast<int>(width)) << "experience" << std::right
              << "  recall/%  nearest/%  unsure/%      good  unreachable\n";
    for (const Answers &answers : results)
        report_line(options, answers, static_cast<int>(width));
    if (results.size() > 1)
        report_line(options, all, static_cast<int>(width));
}

// The label of the map frame of a match: its place, and its position as it came.
void add_label(const vdna_experience &e, uint32_t frame, program::Json &json)
{
    if (e.frame_place && e.frame_place[frame] != VDNA_PLACE_NONE)
        json["place"] = e.frame_place[frame];
    if (e.frame_position && !std::isnan(e.frame_position[size_t{3} * frame]))
        json["position"] = position_json(e.frame_position + size_t{3} * frame, e.position_frame);
}

// null if it is not known.
template <typename Value>
program::Json known(bool is_known, const Value &value)
{
    return is_known ? program::Json(value) : program::Json();
}

program::Json match_json(const record::Match &told, const record::Match &nearest,
                         const record::Recording &live, size_t i)
{
    const bool has_filter = told.confidence.has_value();
    program::Json json = {{"live_frame", live.index[i]},
                          {"utime", live.utime[i]},
                          {"experience", told.experience->name},
                          {"frame", told.frame},
                          {"frame_utime", told.experience->frame_utime[told.frame]},
                          {"good", known(told.judged, told.good)},
                          {"confidence", known(has_filter, told.confidence.value_or(0))},
                          {"moving", known(has_filter, told.moving)},
                          {"nearest_experience", nearest.experience->name},
                          {"nearest_frame", nearest.frame},
                          {"distance", nearest.distance},
                          {"nearest_good", known(nearest.judged, nearest.good)}};
    add_label(*told.experience, told.frame, json);
    return json;
}

program::Json json_of(const LocaliseOptions &options, const Answers &answers,
                      const record::Recording &live)
{
    const record::Localisation &told = answers.told;
    const bool is_labelled = told.judged() > 0;
    program::Json json = {
        {"experience", told.experience},
        {"unit", known(is_labelled, name_of(told.unit))},
        {"recall_percent", known(is_labelled, told.recall_percent())},
        {"nearest_recall_percent", known(is_labelled, answers.nearest.recall_percent())},
        {"unsure_percent",
         known(options.with_filter(), told.unsure_percent(options.min_confidence))},
        {"lost_after_frames", known(told.lost_after > 0, told.lost_after)},
        {"good", known(is_labelled, told.good())},
        {"unreachable", known(is_labelled, told.unreachable())},
        {"judged", told.judged()},
        {"not_labelled_alike", known(!told.difference.empty(), told.difference)}};
    if (!options.matches)
        return json;
    json["matches"] = program::Json::array();
    for (size_t i = 0; i < told.matches.size(); i++)
        json["matches"].push_back(match_json(told.matches[i], answers.nearest.matches[i], live, i));
    return json;
}

void report_json(const LocaliseOptions &options, const Drive &drive,
                 const std::vector<Answers> &results, const Answers &all)
{
    const record::Recording &live = drive.live;
    program::Json candidates = program::Json::array();
    for (const Answers &answers : results)
        candidates.push_back(json_of(options, answers, live));
    program::Json json = {
        {"live", options.live}, {"frames", live.frames}, {"warmup_frames", drive.warmup.frames}};
    json.update(frames::json_of(live.account));
    json.update({{"frames_without_truth", live.without_truth},
                 {"localiser", options.localiser},
                 {"min_confidence", options.min_confidence},
                 {"tolerance", options.tolerance},
                 {"with_altitude", options.with_altitude},
                 {"candidates", candidates},
                 {"all", json_of(options, all, live)}});
    program::print_json(json);
}

Answers composite_of(const std::vector<Answers> &results)
{
    std::vector<record::Localisation> told, nearest;
    for (const Answers &answers : results) {
        told.push_back(answers.told);
        nearest.push_back(answers.nearest);
    }
    return {record::composite_of(told), record::composite_of(nearest)};
}

void localise(const LocaliseOptions &options)
{
    const Map map(options.map);
    const std::vector<const vdna_experience *> picked = picked_from(map, options.in);
    const Drive drive = record(options, map);
    const bool with_matrix = !options.matrix.empty();
    if (with_matrix)
        report::require_drawable(drive.live, picked, options.matrix);
    std::vector<record::Followed> followed;
    for (const vdna_experience *experience : picked)
        followed.push_back(record::follow_in(*experience, drive.warmup, drive.live,
                                             options.tolerance, options.with_altitude,
                                             with_matrix));
    if (with_matrix)
        report::draw_difference_matrices(drive.live, followed, options.with_filter(),
                                         options.matrix);

    std::vector<Answers> results;
    for (const record::Followed &f : followed)
        results.push_back({options.with_filter() ? f.filter : f.nearest, f.nearest});
    const Answers all = composite_of(results);
    options.json ? report_json(options, drive, results, all) : report(options, drive, results, all);
}

} // namespace

void add_localise(CLI::App &app)
{
    CLI::App *command = app.add_subcommand(
        "localise",
        "Localise live frames in the experiences of a map as a robot does, and report Recall@1");
    const auto options = std::make_shared<LocaliseOptions>();
    command
        ->add_option("LIVE_SOURCE", options->live,
                     "folder of pictures, video, LCM log or MCAP file; Recall@1 is reported if it "
                     "carries the same labels as the map")
        ->type_name("PATH")
        ->required();
    command->add_option("MAP", options->map, "directory of the map")->type_name("DIR")->required();
    command
        ->add_option("--in", options->in,
                     "experiences to localise in, each in turn and all together (default: all)")
        ->type_name("NAME");
    command
        ->add_option("--skip", options->warmup_frames,
                     "the first N frames are the warmup: they count for the mean of the live "
                     "frames, the last ten lead the filter, and none is localised")
        ->type_name("N")
        ->capture_default_str();
    command
        ->add_option("--localiser", options->localiser,
                     "filter: by the frames so far, with a confidence; nearest: each frame by "
                     "itself")
        ->check(CLI::IsMember({"filter", "nearest"}))
        ->type_name("NAME")
        ->capture_default_str();
    command
        ->add_option("--min-confidence", options->min_confidence,
                     "answers of less confidence count as unsure")
        ->check(program::within(0, 1))
        ->type_name("0..1")
        ->capture_default_str();
    command
        ->add_option("--tolerance", options->tolerance,
                     "a match is good within T places, or metres if both sides have positions")
        ->check(program::within(0, 1e9))
        ->type_name("T")
        ->capture_default_str();
    command
        ->add_option("--matrix", options->matrix,
                     "draw the difference matrices, as .png, .svg or .pdf, the most recall first: "
                     "near = black, far = "
                     "white; the answers of the localiser as green dots if right, orange crosses "
                     "if wrong, grey dots where that is not known")
        ->type_name("FILE");
    add_network_options(*command, options->network, "that of the map");
    add_source_options(*command, options->source);
    add_labels_option(*command, options->source);
    add_track_options(*command, options->source);
    add_altitude_option(*command, options->with_altitude);
    command->add_flag("--matches", options->matches, "with --json: list the match of every frame");
    command->add_flag("--json", options->json, "report as JSON");
    command->footer("Examples:\n"
                    "  vdna localise --skip 42 --tolerance 10 today/ park\n"
                    "  vdna localise today/ park --in winter --matrix winter.png");
    command->callback([options] { localise(*options); });
}

} // namespace vdna::tool
