// vdna rank - orders experiences by the distance of their Visual DNA to a query.
#include <cmath>
#include <memory>

#include <vdna/cpp/error.hpp>
#include <vdna/cpp/map.hpp>
#include <vdna/cpp/selector.hpp>
#include <vdna/cpp/taps.hpp>
#include <vdna/cpp/trust.hpp>
#include <vdna/rank.h>

#include "program/choice_sentence.hpp"
#include "program/decimal.hpp"
#include "program/exit_code.hpp"
#include "record/candidates.hpp"
#include "record/experiences.hpp"
#include "record/pass.hpp"
#include "record/warmup.hpp"
#include "vdna/commands.hpp"
#include "vdna/options.hpp"
#include "vdna/ranking_report.hpp"

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
    std::string by = "transfer";
    double min_recall = 0;
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
    require(vdna_select_feed_seen(selector.get(), &frame, pass.output().last_layer, &answer),
            pass.frame().name);
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

std::vector<vdna_experience> candidates_of(const RankOptions &options, const Map &map)
{
    std::vector<vdna_experience> candidates; // borrowed
    for (const size_t i : record::all_but(map, options.exclude))
        candidates.push_back(map.experiences()[i]);
    if (candidates.empty())
        throw Error(options.paths[1] + ": --exclude leaves no experience to rank");
    return candidates;
}

Trust trust_in(const RankOptions &options, const std::vector<vdna_experience> &candidates)
{
    vdna_trust_config config = trust_defaults();
    config.min_recall = options.min_recall;
    return {options.paths[1], candidates, config};
}

// A selector among these experiences, for frames of a source.
std::unique_ptr<Selector> selector_of(const RankOptions &options,
                                      const std::vector<vdna_experience> &experiences, Trust &trust)
{
    std::vector<vdna_select_candidate> candidates;
    for (const vdna_experience &experience : experiences)
        candidates.push_back(candidate_of(experience));
    // A source's times are in microseconds already.
    const Stamps stamps = {static_cast<int64_t>(options.source.late_s * 1e6), VDNA_TIME_UNIT_US};
    Trusting trusting;
    trusting.trust = trust.get();
    trusting.runs = trust.runs().data();
    trusting.rank = options.by == "emd" ? VDNA_SELECT_BY_EMD : VDNA_SELECT_BY_TRANSFER;
    return std::make_unique<Selector>(std::move(candidates), experiences.front().identity.dim,
                                      record::warmup_of(options.warmup, options.warmup_frames_min),
                                      options.paths[1], stamps, Localising{}, trusting);
}

// What the selector has found out about the candidates.
void take_from(const vdna_select &select, Ranking &ranking)
{
    uint32_t count = 0;
    const vdna_rank_entry *const entries = vdna_select_ranking(&select, &count);
    ranking.frames = vdna_select_window_frames(&select);
    ranking.restarts = vdna_select_restarts(&select);
    if (ranking.restarts > 0)
        ranking.account.notes.push_back(restart_note(select));
    ranking.entries.assign(entries, entries + count);
    ranking.ranked_by = vdna_select_ranked_by(&select);
}

std::string sentence_of(const vdna_select &select, const Trust &trust,
                        const std::vector<vdna_experience> &candidates)
{
    const uint32_t chosen = vdna_select_chosen(&select);
    const vdna_trust_prediction &prediction = vdna_select_predictions(&select, nullptr)[chosen];
    const vdna_trust_answer &answer = *vdna_select_trust(&select);
    program::Choice choice{};
    choice.experience = candidates[chosen].name;
    choice.previous = "";
    choice.count = static_cast<int>(candidates.size());
    choice.frames = static_cast<int>(vdna_select_window_frames(&select));
    choice.verdict = name_of_verdict(answer.verdict);
    choice.unlike = answer.unlike;
    choice.predicted_recall = prediction.recall;
    choice.predicted_low = prediction.low;
    choice.predicted_high = prediction.high;
    choice.no_prediction = trust.text_of(prediction.reason);
    choice.skill = trust.skill();
    return program::sentence_of(choice).data();
}

Expectation expectation_of(const vdna_select &select, const Trust &trust,
                           const std::vector<vdna_experience> &candidates)
{
    uint32_t count = 0;
    const vdna_trust_prediction *const predictions = vdna_select_predictions(&select, &count);
    Expectation expectation;
    expectation.answer = *vdna_select_trust(&select);
    expectation.fit = trust.fit();
    expectation.predictions.assign(predictions, predictions + count);
    expectation.sentence = sentence_of(select, trust, candidates);
    return expectation;
}

// Rank a map by the first frames of a source, as the daemon would.
Ranking rank_live(const RankOptions &options)
{
    const std::string &source = options.paths[0];
    const Map map(options.paths[1]);
    const vdna_identity &identity = map.experiences().front().identity;
    const std::vector<vdna_experience> candidates = candidates_of(options, map);
    Trust trust = trust_in(options, candidates);
    const std::unique_ptr<Selector> selector = selector_of(options, candidates, trust);
    Backbone backbone(options.network.backbone.empty() ? identity.backbone
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
    ranking.account = pass.account();
    take_from(*selector->get(), ranking);
    tell(source, ranking.account);
    ranking.expectation = expectation_of(*selector->get(), trust, candidates);
    for (const vdna_experience &candidate : candidates)
        ranking.names.emplace_back(candidate.name);
    if (options.per_tap) {
        vdna_hist_view live;
        vdna_select_live(selector->get(), &live);
        add_taps(ranking, identity.taps, live, views_of(*selector));
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
    command
        ->add_option("--warmup", options->warmup,
                     "live: the first N frames, or T seconds of camera time, are the query")
        ->type_name("N|Ts")
        ->capture_default_str();
    add_warmup_min_option(*command, options->warmup_frames_min);
    command->add_option("--exclude", options->exclude, "live: leave these experiences out")
        ->type_name("NAME");
    command
        ->add_option("--rank", options->by,
                     "live: transfer, the recall that the map's own runs of this look got, where "
                     "labels tell it, and distance otherwise; or emd, distance, as in the paper")
        ->check(CLI::IsMember({"transfer", "emd"}))
        ->type_name("NAME")
        ->capture_default_str();
    command
        ->add_option(
            "--min-recall", options->min_recall,
            "live: no experience fits if the best predicted recall is below R; 0: whatever "
            "is predicted")
        ->check(program::within(0, 1))
        ->type_name("R")
        ->capture_default_str();
    command->add_flag("--per-tap", options->per_tap,
                      "also report the distance of each activation tap");
    add_network_options(*command, options->network, "that of the map");
    add_source_options(*command, options->source);
    add_labels_option(*command, options->source);
    add_track_options(*command, options->source);
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
