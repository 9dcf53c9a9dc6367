// vdna localise - localises live frames in the experiences of a map and reports Recall@1.
#include <cmath>
#include <iomanip>

#include <vdna/cpp/map.hpp>

#include "program/print.hpp"
#include "record/candidates.hpp"
#include "record/localisation.hpp"
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
    std::vector<std::string> in;
    double tolerance = 5;
    bool with_altitude = false;
    std::string matrix;
    bool matches = false;
    bool json = false;
};

record::Recording record(const LocaliseOptions &options, const Map &map)
{
    const NetworkOptions &network = options.network;
    Backbone backbone(network.backbone.empty() ? map.experiences().front().identity.backbone
                                               : network.backbone,
                      network.threads);
    map.require_backbone(backbone.info());
    record::Recording live;
    record::Pass pass(options.live, options.source, backbone);
    while (pass.next())
        live.add(pass);
    live.account = pass.account();
    live.require_frames(options.live);
    tell(options.live, live.account);
    return live;
}

std::vector<const vdna_experience *> picked_from(const Map &map,
                                                 const std::vector<std::string> &names)
{
    std::vector<const vdna_experience *> picked;
    for (const size_t i : names.empty() ? record::all_but(map, {}) : record::named_in(map, names))
        picked.push_back(&map.experiences()[i]);
    return picked;
}

void report_line(const record::Localisation &l, int width)
{
    std::cout << std::left << std::setw(width) << l.experience << std::right;
    if (l.judged() == 0)
        std::cout << "         -         -            -  not labelled alike"
                  << (l.difference.empty() ? "" : ": " + l.difference) << '\n';
    else
        std::cout << std::setw(10) << program::fixed(l.recall_percent(), 2) << std::setw(10)
                  << l.good() << std::setw(13) << l.unreachable() << '\n';
}

void report(const LocaliseOptions &options, const record::Recording &live,
            const std::vector<record::Localisation> &results)
{
    size_t width = std::string("experience").size();
    for (const record::Localisation &l : results)
        width = std::max(width, l.experience.size());
    std::cout << options.live << ": " << live.frames << " frames";
    if (live.account.bad > 0)
        std::cout << ", " << live.account.bad << " bad ones left out";
    const record::Localisation &first = results.front();
    if (const size_t unknown = live.frames - first.judged(); first.judged() > 0 && unknown > 0)
        std::cout << ", " << unknown << " without ground truth left out of the recall";
    if (first.judged() > 0)
        std::cout << ", tolerance " << options.tolerance << ' ' << name_of(first.unit)
                  << (options.with_altitude ? " with altitude" : "");
    std::cout << '\n'
              << std::left << std::setw(static_cast<int>(width)) << "experience" << std::right
              << "  recall/%      good  unreachable\n";
    for (const record::Localisation &l : results)
        report_line(l, static_cast<int>(width));
    if (results.size() > 1)
        report_line(record::composite_of(results), static_cast<int>(width));
}

// The label of the map frame of a match: its place, and its position as it came.
void add_label(const vdna_experience &e, uint32_t frame, program::Json &json)
{
    if (e.frame_place && e.frame_place[frame] != VDNA_PLACE_NONE)
        json["place"] = e.frame_place[frame];
    if (e.frame_position && !std::isnan(e.frame_position[size_t{3} * frame]))
        json["position"] = position_json(e.frame_position + size_t{3} * frame, e.position_frame);
}

program::Json match_json(const record::Match &match, const record::Recording &live, size_t i)
{
    const auto judged = [&](bool value) {
        return match.judged ? program::Json(value) : program::Json();
    };
    program::Json json = {{"live_frame", live.index[i]},
                          {"utime", live.utime[i]},
                          {"experience", match.experience->name},
                          {"frame", match.frame},
                          {"frame_utime", match.experience->frame_utime[match.frame]},
                          {"distance", match.distance},
                          {"good", judged(match.good)}};
    add_label(*match.experience, match.frame, json);
    return json;
}

program::Json json_of(const record::Localisation &l, const record::Recording &live,
                      bool with_matches)
{
    const bool labelled = l.judged() > 0;
    program::Json json = {
        {"experience", l.experience},
        {"unit", labelled ? program::Json(name_of(l.unit)) : program::Json()},
        {"recall_percent", labelled ? program::Json(l.recall_percent()) : program::Json()},
        {"good", labelled ? program::Json(l.good()) : program::Json()},
        {"unreachable", labelled ? program::Json(l.unreachable()) : program::Json()},
        {"judged", l.judged()},
        {"not_labelled_alike",
         l.difference.empty() ? program::Json() : program::Json(l.difference)}};
    if (!with_matches)
        return json;
    json["matches"] = program::Json::array();
    for (size_t i = 0; i < l.matches.size(); i++)
        json["matches"].push_back(match_json(l.matches[i], live, i));
    return json;
}

void report_json(const LocaliseOptions &options, const record::Recording &live,
                 const std::vector<record::Localisation> &results)
{
    program::Json candidates = program::Json::array();
    for (const record::Localisation &l : results)
        candidates.push_back(json_of(l, live, options.matches));
    program::Json json = {{"live", options.live}, {"frames", live.frames}};
    json.update(frames::json_of(live.account));
    json.update({{"frames_without_truth", live.without_truth},
                 {"tolerance", options.tolerance},
                 {"with_altitude", options.with_altitude},
                 {"candidates", candidates},
                 {"all", json_of(record::composite_of(results), live, options.matches)}});
    program::print_json(json);
}

void localise(const LocaliseOptions &options)
{
    const Map map(options.map);
    const std::vector<const vdna_experience *> picked = picked_from(map, options.in);
    const record::Recording live = record(options, map);
    std::vector<record::Localisation> results;
    for (const vdna_experience *experience : picked)
        results.push_back(
            record::localise_in(*experience, live, options.tolerance, 1, options.with_altitude));
    if (!options.matrix.empty())
        report::draw_difference_matrices(live, picked, results, options.matrix);
    options.json ? report_json(options, live, results) : report(options, live, results);
}

} // namespace

void add_localise(CLI::App &app)
{
    CLI::App *command = app.add_subcommand(
        "localise", "Localise live frames in the experiences of a map, and report Recall@1");
    const auto options = std::make_shared<LocaliseOptions>();
    command
        ->add_option("LIVE_SOURCE", options->live,
                     "folder of pictures, video file or LCM log; Recall@1 is reported if it "
                     "carries the same labels as the map")
        ->type_name("")
        ->required();
    command->add_option("MAP", options->map, "directory of the map")->type_name("")->required();
    command
        ->add_option("--in", options->in,
                     "experiences to localise in, each in turn and all together (default: all)")
        ->type_name("NAME");
    command->add_option("--skip", options->source.skip, "leave out the first N frames, the warmup")
        ->type_name("N")
        ->capture_default_str();
    command
        ->add_option("--tolerance", options->tolerance,
                     "a match is good within T places, or metres if both sides have positions")
        ->check(CLI::Validator(CLI::NonNegativeNumber).description(""))
        ->type_name("T")
        ->capture_default_str();
    command
        ->add_option("--matrix", options->matrix,
                     "draw the difference matrices: near = black, far = white, good matches "
                     "blue, others orange")
        ->type_name("OUT.png");
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
