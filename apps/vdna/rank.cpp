// vdna rank - orders experiences by the distance of their Visual DNA to a query.
#include <filesystem>
#include <memory>

#include <vdna/cpp/error.hpp>
#include <vdna/cpp/taps.hpp>
#include <vdna/rank.h>

#include "program/exit_code.hpp"
#include "record/experiences.hpp"
#include "vdna/commands.hpp"
#include "vdna/live_ranking.hpp"
#include "vdna/options.hpp"
#include "vdna/ranking_report.hpp"

namespace vdna::tool
{

namespace
{

struct RankOptions {
    std::vector<std::string> paths;
    LiveOptions live;
    bool per_tap = false;
    bool json = false;
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

// Rank a map by the first frames of a source, as the daemon would.
Ranking rank_live(const RankOptions &options)
{
    LiveOptions given = options.live;
    given.path = options.paths[0];
    given.map = options.paths[1];
    const LiveRanking live(given);
    Ranking ranking = live.ranking();
    if (options.per_tap) {
        std::vector<vdna_hist_view> candidates;
        for (const vdna_experience &candidate : live.candidates())
            vdna_experience_view(&candidate, &candidates.emplace_back());
        add_taps(ranking, live.identity().taps, live.live(), candidates);
    }
    return ranking;
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
    if (ranking.expectation && ranking.expectation->answer.verdict != VDNA_TRUST_FITS)
        throw program::NoneFits();
}

} // namespace

void add_rank(CLI::App &app)
{
    CLI::App *command = app.add_subcommand(
        "rank",
        "Order experiences by how well a query will be localised in them, or by the distance "
        "of their Visual DNA");
    const auto options = std::make_shared<RankOptions>();
    command
        ->add_option(
            "PATH", options->paths,
            "LIVE_SOURCE MAP: a folder of pictures, video, LCM log or MCAP file, and the map to "
            "choose from; or experience files, the first of which is the query")
        ->type_name("PATH")
        ->expected(2, -1)
        ->required();
    add_live_options(*command, options->live, "live: ");
    command->add_flag("--per-tap", options->per_tap,
                      "also report the distance of each activation tap");
    add_network_options(*command, options->live.network, "that of the map");
    add_source_options(*command, options->live.source);
    add_labels_option(*command, options->live.source);
    add_track_options(*command, options->live.source);
    command->add_flag("--json", options->json, "report as JSON");
    command->footer(
        "Recalls are predicted, with the interval of 80 %, of a map that knows itself: see "
        "vdna calibrate --trust. Exit code 3: none of the experiences fits.\n\n"
        "Examples:\n"
        "  vdna rank --warmup 42 today/ park\n"
        "  vdna rank park/winter.vdna park/summer.vdna park/autumn.vdna");
    command->callback([options] { rank(*options); });
}

} // namespace vdna::tool
