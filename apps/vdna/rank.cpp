// vdna rank - orders experiences by the distance of their Visual DNA to a query.
#include <iomanip>
#include <memory>

#include <vdna/cpp/error.hpp>
#include <vdna/cpp/map.hpp>
#include <vdna/cpp/selector.hpp>
#include <vdna/cpp/taps.hpp>
#include <vdna/rank.h>

#include "program/exit_code.hpp"
#include "program/print.hpp"
#include "record/candidates.hpp"
#include "record/experiences.hpp"
#include "record/pass.hpp"
#include "record/warmup.hpp"
#include "vdna/commands.hpp"
#include "vdna/options.hpp"

namespace vdna::tool
{

namespace
{

struct RankOptions {
    std::vector<std::string> paths;
    NetworkOptions network;
    frames::SourceOptions source;
    std::string warmup = std::to_string(VDNA_WARMUP_FRAMES_DEFAULT);
    uint32_t warmup_frames_min = VDNA_WARMUP_FRAMES_MIN_DEFAULT;
    std::vector<std::string> exclude;
    bool per_tap = false;
    bool json = false;
};

// A ranking with the facts to report.
struct Ranking {
    std::string query;
    uint32_t frames = 0;            // of the query
    uint64_t restarts = 0;          // of the warmup
    frames::Account account;        // of a live query
    uint64_t without_truth = 0;     // frames without the ground truth that others have
    std::vector<std::string> names; // [candidates]
    std::vector<vdna_rank_entry> entries;
    std::vector<Tap> taps;                          // empty unless requested
    std::vector<std::vector<double>> tap_distances; // [candidates][taps], bins
};

// The distance of each tap's neurons.
std::vector<double> tap_distances(const vdna_hist_view &query, const vdna_hist_view &candidate,
                                  const std::vector<Tap> &taps)
{
    std::vector<int64_t> scratch(vdna_emd_scratch_size(query.neurons) / sizeof(int64_t) + 1);
    std::vector<double> neuron_emd(query.neurons);
    require(vdna_emd(&query, &candidate, scratch.data(), scratch.size() * sizeof(int64_t),
                     neuron_emd.data()),
            "distance per tap");
    return tap_means(neuron_emd, taps);
}

void add_taps(Ranking &ranking, const std::string &taps, const vdna_hist_view &query,
              const std::vector<vdna_hist_view> &candidates)
{
    ranking.taps = taps_of(taps, query.neurons);
    for (const vdna_hist_view &candidate : candidates)
        ranking.tap_distances.push_back(tap_distances(query, candidate, ranking.taps));
}

// Rank the other experience files against the first.
Ranking rank_files(const RankOptions &options)
{
    const std::vector<Experience> files = record::open_experiences(options.paths);
    if (files.size() < 2)
        throw program::UsageError(options.paths[0] +
                                  ": nothing to rank, expected QUERY.vdna CANDIDATE.vdna...");
    Ranking ranking;
    ranking.query = files[0].path().string();
    ranking.frames = files[0]->frames;
    vdna_hist_view query;
    vdna_experience_view(files[0].get(), &query);
    std::vector<vdna_hist_view> candidates;
    for (size_t i = 1; i < files.size(); i++) {
        vdna_error error{};
        if (vdna_experience_compare(files[0].get(), files[i].get(), &error) != VDNA_OK)
            throw Error(files[i].path().string() + ": does not compare with " + ranking.query +
                        ": " + error.text + "; build both with the same backbone and ranges");
        vdna_experience_view(files[i].get(), &candidates.emplace_back());
        ranking.names.push_back(files[i]->name);
    }
    ranking.entries.resize(candidates.size());
    std::vector<int64_t> scratch(vdna_emd_scratch_size(query.neurons) / sizeof(int64_t) + 1);
    require(vdna_rank(&query, candidates.data(), static_cast<uint32_t>(candidates.size()),
                      scratch.data(), scratch.size() * sizeof(int64_t), ranking.entries.data()),
            ranking.query);
    if (options.per_tap)
        add_taps(ranking, files[0]->identity.taps, query, candidates);
    return ranking;
}

std::vector<vdna_hist_view> views_of(const Selector &selector)
{
    std::vector<vdna_hist_view> views;
    for (const vdna_select_candidate &candidate : selector.candidates())
        views.push_back(candidate.dna);
    return views;
}

// True once the warmup is complete.
bool feed(Selector &selector, const Map &map, const record::Pass &pass, std::vector<float> &room)
{
    const vdna_select_frame frame = {pass.frame().utime, pass.output().taps,
                                     pass.output().tap_count,
                                     map.embedding_of(pass.output(), room)};
    vdna_select_answer answer;
    require(vdna_select_feed(selector.get(), &frame, &answer), pass.frame().name);
    return answer.newly_ranked != 0;
}

std::string restart_note(const vdna_select &select)
{
    const uint64_t restarts = vdna_select_restarts(&select);
    return "the warmup began anew " + std::to_string(restarts) +
           (restarts == 1 ? " time, " : " times, the last time ") +
           vdna_restart_text(vdna_select_restart_cause(&select));
}

// Why a warmup did not end, and what to do.
std::string reason_of(const vdna_select &select, const frames::Account &account)
{
    const uint64_t restarts = vdna_select_restarts(&select);
    const uint32_t frames = vdna_select_window_frames(&select);
    if (frames > 1 && vdna_select_time(&select)->still + 1 >= frames)
        return "camera time stands still, so give --warmup in frames";
    if (restarts > 0)
        return restart_note(select) + "; correct the stamps";
    if (account.bad > 0)
        return std::to_string(account.bad) +
               " bad frames are left out, the first: " + account.first_bad;
    return "set a shorter --warmup";
}

[[noreturn]] void complain_of_incomplete_warmup(const RankOptions &options,
                                                const vdna_select &select,
                                                const frames::Account &account)
{
    tell(options.paths[0], account);
    throw Error(options.paths[0] + ": ends after " +
                std::to_string(vdna_select_window_frames(&select)) +
                " frames of the warmup, expected " + options.warmup +
                (options.warmup.back() == 's' ? " and a frame after it; " : " frames; ") +
                reason_of(select, account));
}

// A selector among these experiences of a map, for frames of a source.
std::unique_ptr<Selector> selector_of(const RankOptions &options, const Map &map,
                                      const std::vector<size_t> &picked)
{
    if (picked.empty())
        throw Error(options.paths[1] + ": --exclude leaves no experience to rank");
    std::vector<vdna_select_candidate> candidates;
    for (const size_t i : picked)
        candidates.push_back(map.candidates()[i]);
    // A source's times are in microseconds already.
    const Stamps stamps = {static_cast<int64_t>(options.source.late_s * 1e6), VDNA_TIME_UNIT_US};
    return std::make_unique<Selector>(std::move(candidates), map.experiences().front().identity.dim,
                                      record::warmup_of(options.warmup, options.warmup_frames_min),
                                      options.paths[1], stamps);
}

// Rank a map by the first frames of a source, as the daemon would.
Ranking rank_live(const RankOptions &options)
{
    const std::string &source = options.paths[0];
    const Map map(options.paths[1]);
    const vdna_experience &first = map.experiences().front();
    const std::vector<size_t> picked = record::all_but(map, options.exclude);
    const std::unique_ptr<Selector> selector = selector_of(options, map, picked);
    Backbone backbone(options.network.backbone.empty() ? first.identity.backbone
                                                       : options.network.backbone,
                      options.network.threads);
    map.require_backbone(backbone.info());

    record::Pass pass(source, options.source, backbone);
    Ranking ranking;
    bool complete = false;
    std::vector<float> room;
    while (!complete && pass.next()) {
        complete = feed(*selector, map, pass, room);
        ranking.without_truth += pass.frame().label.lacks_truth;
    }
    if (!complete)
        complain_of_incomplete_warmup(options, *selector->get(), pass.account());

    ranking.query = source;
    ranking.frames = vdna_select_window_frames(selector->get());
    ranking.restarts = vdna_select_restarts(selector->get());
    ranking.account = pass.account();
    if (ranking.restarts > 0)
        ranking.account.notes.push_back(restart_note(*selector->get()));
    tell(source, ranking.account);
    const vdna_rank_entry *const entries = vdna_select_ranking(selector->get(), nullptr);
    ranking.entries.assign(entries, entries + picked.size());
    for (const size_t i : picked)
        ranking.names.push_back(map.experiences()[i].name);
    if (options.per_tap) {
        vdna_hist_view live;
        vdna_select_live(selector->get(), &live);
        add_taps(ranking, first.identity.taps, live, views_of(*selector));
    }
    return ranking;
}

double margin_of(const Ranking &ranking)
{
    const std::vector<vdna_rank_entry> &e = ranking.entries;
    return e.size() > 1 ? e[1].distance_bins - e[0].distance_bins : 0;
}

void report(const Ranking &ranking)
{
    size_t width = std::string("experience").size();
    for (const std::string &name : ranking.names)
        width = std::max(width, name.size());
    const auto column = [&](const std::string &text) {
        std::cout << "  " << std::setw(14) << text;
    };

    std::cout << ranking.query << ": " << ranking.frames << " frames";
    if (ranking.without_truth > 0)
        std::cout << ", " << ranking.without_truth << " without ground truth";
    std::cout << "\nrank  " << std::left << std::setw(static_cast<int>(width)) << "experience"
              << std::right;
    column("distance/bins");
    for (const Tap &tap : ranking.taps)
        column(tap.name);
    std::cout << '\n';
    for (size_t i = 0; i < ranking.entries.size(); i++) {
        const vdna_rank_entry &entry = ranking.entries[i];
        std::cout << std::setw(4) << i + 1 << "  " << std::left
                  << std::setw(static_cast<int>(width)) << ranking.names[entry.candidate]
                  << std::right;
        column(program::fixed(entry.distance_bins, 4));
        for (size_t t = 0; t < ranking.taps.size(); t++)
            column(program::fixed(ranking.tap_distances[entry.candidate][t], 4));
        std::cout << (entry.tied ? "  tied\n" : "\n");
    }
    std::cout << "margin of the first choice: " << program::fixed(margin_of(ranking), 4)
              << " bins\n";
}

void report_json(const Ranking &ranking)
{
    program::Json entries = program::Json::array();
    for (const vdna_rank_entry &entry : ranking.entries) {
        program::Json json = {{"experience", ranking.names[entry.candidate]},
                              {"distance_bins", entry.distance_bins},
                              {"tied", entry.tied != 0}};
        for (size_t t = 0; t < ranking.taps.size(); t++)
            json["taps"].push_back({{"tap", ranking.taps[t].name},
                                    {"distance_bins", ranking.tap_distances[entry.candidate][t]}});
        entries.push_back(json);
    }
    program::Json json = {{"query", ranking.query}, {"frames", ranking.frames}};
    json.update(frames::json_of(ranking.account));
    json.update({{"frames_without_truth", ranking.without_truth},
                 {"restarts", ranking.restarts},
                 {"margin_bins", margin_of(ranking)},
                 {"ranking", entries}});
    program::print_json(json);
}

void rank(const RankOptions &options)
{
    const bool files = std::filesystem::path(options.paths[0]).extension() == VDNA_MAP_EXTENSION &&
                       !std::filesystem::is_directory(options.paths[0]);
    if (!files && options.paths.size() != 2)
        throw program::UsageError(
            "found " + std::to_string(options.paths.size()) +
            " paths, expected LIVE_SOURCE MAP or QUERY.vdna CANDIDATE.vdna...");
    const Ranking ranking = files ? rank_files(options) : rank_live(options);
    options.json ? report_json(ranking) : report(ranking);
}

} // namespace

void add_rank(CLI::App &app)
{
    CLI::App *command = app.add_subcommand(
        "rank", "Order experiences by the distance of their Visual DNA to a query");
    const auto options = std::make_shared<RankOptions>();
    command
        ->add_option("PATH", options->paths,
                     "LIVE_SOURCE MAP: a folder of pictures, video file or LCM log, and the map to "
                     "choose from; or experience files, the first of which is the query")
        ->type_name("")
        ->expected(2, -1)
        ->required();
    command
        ->add_option("--warmup", options->warmup,
                     "live: the first N frames, or T seconds of camera time, are the query")
        ->type_name("N|Ts")
        ->capture_default_str();
    add_warmup_min_option(*command, options->warmup_frames_min);
    command->add_option("--exclude", options->exclude, "live: leave these experiences out")
        ->type_name("NAME");
    command->add_flag("--per-tap", options->per_tap,
                      "also report the distance of each activation tap");
    add_network_options(*command, options->network, "that of the map");
    add_source_options(*command, options->source);
    add_labels_option(*command, options->source);
    add_track_options(*command, options->source);
    command->add_flag("--json", options->json, "report as JSON");
    command->footer("Examples:\n"
                    "  vdna rank --warmup 42 today/ park\n"
                    "  vdna rank park/winter.vdna park/summer.vdna park/autumn.vdna");
    command->callback([options] { rank(*options); });
}

} // namespace vdna::tool
