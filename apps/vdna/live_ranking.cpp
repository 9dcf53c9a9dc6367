#include "vdna/live_ranking.hpp"

#include <vdna/cpp/error.hpp>

#include "program/choice_sentence.hpp"
#include "program/decimal.hpp"
#include "record/candidates.hpp"
#include "record/warmup.hpp"

namespace vdna::tool
{

namespace
{

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

[[noreturn]] void complain_of_incomplete_warmup(const LiveOptions &options,
                                                const vdna_select &select,
                                                const frames::Account &account)
{
    tell(options.path, account);
    throw Error(options.path + ": ends after " +
                std::to_string(vdna_select_window_frames(&select)) +
                " frames of the warmup, expected " + options.warmup +
                (options.warmup.back() == 's' ? " and a frame after it; " : " frames; ") +
                reason_of(select, account));
}

std::vector<vdna_experience> candidates_of(const LiveOptions &options, const Map &map)
{
    std::vector<vdna_experience> candidates; // borrowed
    for (const size_t i : record::all_but(map, options.exclude))
        candidates.push_back(map.experiences()[i]);
    if (candidates.empty())
        throw Error(options.map + ": --exclude leaves no experience to rank");
    return candidates;
}

Trust trust_in(const LiveOptions &options, const std::vector<vdna_experience> &candidates)
{
    vdna_trust_config config = trust_defaults();
    config.min_recall = options.min_recall;
    return {options.map, candidates, config};
}

// A selector among these experiences, for frames of a source.
std::unique_ptr<Selector> selector_of(const LiveOptions &options,
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
                                      options.map, stamps, Localising{}, trusting);
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

} // namespace

LiveRanking::LiveRanking(const LiveOptions &options, const Watcher &watch)
    : map_(options.map), candidates_(candidates_of(options, map_)),
      trust_(trust_in(options, candidates_)), selector_(selector_of(options, candidates_, trust_))
{
    Backbone backbone(options.network.backbone.empty() ? identity().backbone
                                                       : options.network.backbone,
                      options.network.threads);
    map_.require_backbone(backbone.info());
    record::Pass pass(options.path, options.source, backbone);
    bool complete = false;
    std::vector<float> room;
    while (!complete && pass.next()) {
        complete = feed(*selector_, map_, pass, room);
        ranking_.without_truth += pass.frame().label.lacks_truth;
        if (watch)
            watch(pass);
    }
    if (!complete)
        complain_of_incomplete_warmup(options, *selector_->get(), pass.account());

    ranking_.query = options.path;
    ranking_.account = pass.account();
    take_from(*selector_->get(), ranking_);
    tell(options.path, ranking_.account);
    ranking_.expectation = expectation_of(*selector_->get(), trust_, candidates_);
    for (const vdna_experience &candidate : candidates_)
        ranking_.names.emplace_back(candidate.name);
}

vdna_hist_view LiveRanking::live() const
{
    vdna_hist_view view{};
    vdna_select_live(selector_->get(), &view);
    return view;
}

void add_live_options(CLI::App &command, LiveOptions &options, const std::string &when)
{
    command
        .add_option("--warmup", options.warmup,
                    when + "the first N frames, or T seconds of camera time, are the query")
        ->type_name("N|Ts")
        ->capture_default_str();
    add_warmup_min_option(command, options.warmup_frames_min);
    command.add_option("--exclude", options.exclude, when + "leave these experiences out")
        ->type_name("NAME");
    command
        .add_option("--rank", options.by,
                    when + "transfer, the recall that the map's own runs of this look got, where "
                           "labels tell it, and distance otherwise; or emd, distance, as in the "
                           "paper")
        ->check(CLI::IsMember({"transfer", "emd"}))
        ->type_name("NAME")
        ->capture_default_str();
    command
        .add_option("--min-recall", options.min_recall,
                    when + "no experience fits if the best predicted recall is below R; 0: "
                           "whatever is predicted")
        ->check(program::within(0, 1))
        ->type_name("R")
        ->capture_default_str();
}

} // namespace vdna::tool
