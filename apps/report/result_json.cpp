#include "report/result_json.hpp"

#include <cmath>

#include "eval/placing.hpp"
#include "report/csv_field.hpp"
#include "report/localisers.hpp"
#include "report/reselection.hpp"
#include "report/trust.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

program::Json methods_of(const std::vector<eval::MethodResult> &methods)
{
    program::Json json = program::Json::object();
    for (const eval::MethodResult &method : methods)
        json[method.name] = json_of(method.judged);
    return json;
}

// {query: {reference: value of its outcome, "all": value}}
template <typename Value>
program::Json outcomes_of(const eval::Evaluation &evaluation, Value value)
{
    program::Json json = program::Json::object();
    for (const eval::QueryResult &query : evaluation.queries) {
        program::Json &row = json[name_of(evaluation, query.traversal)];
        for (const eval::PairResult &pair : query.pairs)
            row[name_of(evaluation, pair.reference)] = value(pair.outcome);
        row["all"] = value(query.all);
    }
    return json;
}

program::Json distances_of(const eval::Evaluation &evaluation, const eval::MethodResult &method)
{
    program::Json json = program::Json::object();
    const size_t columns = evaluation.references.size();
    for (size_t q = 0; q < evaluation.queries.size(); q++)
        for (size_t r = 0; r < columns; r++)
            if (!std::isnan(method.distance[q * columns + r]))
                json[name_of(evaluation, evaluation.queries[q].traversal)]
                    [name_of(evaluation, evaluation.references[r])] =
                        method.distance[q * columns + r];
    return json;
}

program::Json frames_of(const eval::Evaluation &evaluation)
{
    program::Json json = program::Json::object();
    for (const eval::QueryResult &query : evaluation.queries) {
        const record::Recording &recording = (*evaluation.traversals)[query.traversal].recording;
        json[name_of(evaluation, query.traversal)] = {{"frames", recording.frames},
                                                      {"bad", recording.account.bad},
                                                      {"late", recording.account.late},
                                                      {"order", recording.account.order},
                                                      {"without_truth", recording.without_truth},
                                                      {"warmup", query.warmup_frames},
                                                      {"live", query.live.size()}};
    }
    return json;
}

program::Json names_of_queries(const eval::Evaluation &evaluation)
{
    program::Json names = program::Json::array();
    for (const eval::QueryResult &query : evaluation.queries)
        names.push_back(name_of(evaluation, query.traversal));
    return names;
}

// 42 frames as a number, "45s" as a text.
program::Json warmup_of(const eval::Evaluation &evaluation)
{
    const bool seconds = evaluation.warmup.back() == 's';
    return seconds ? program::Json(evaluation.warmup)
                   : program::Json(std::stoul(evaluation.warmup));
}

program::Json counts_of(const eval::Outcome &outcome)
{
    return {{"good", outcome.good},
            {"total", outcome.judged},
            {"unreachable", outcome.unreachable},
            {"without_truth", outcome.matches.size() - outcome.judged}};
}

program::Json queries_that_rank_nothing(const eval::Evaluation &evaluation)
{
    program::Json names = program::Json::array();
    for (size_t q = 0; q < evaluation.queries.size(); q++)
        if (!eval::truth_ranks(evaluation, q))
            names.push_back(name_of(evaluation, evaluation.queries[q].traversal));
    return names;
}

std::string csv_row(const std::string &query, const std::string &reference,
                    const eval::Outcome &outcome)
{
    return csv_field(query) + "," + csv_field(reference) + "," +
           program::Json(outcome.recall[0]).dump() + "," + std::to_string(outcome.good) + "," +
           std::to_string(outcome.judged) + "," + std::to_string(outcome.unreachable);
}

// Of those localisers whose recalls are not in the column recall_percent.
std::string localiser_cells(const eval::Evaluation &evaluation, const LocaliserRow &row)
{
    std::string cells;
    for (const size_t i : beyond_usual_localisers(evaluation))
        cells += "," + (std::isnan(row.recall[i]) ? "" : program::Json(row.recall[i]).dump());
    return cells;
}

std::string prediction_columns(const eval::TrustPair &pair)
{
    std::string cells;
    for (const double value : prediction_cells(pair))
        cells += "," + (std::isnan(value) ? "" : program::Json(value).dump());
    return cells;
}

std::string end_of_row(const eval::Outcome &outcome, const std::string &note)
{
    return "," + std::to_string(outcome.matches.size() - outcome.judged) + "," + csv_field(note) +
           "\n";
}

} // namespace

program::Json json_of(const eval::JudgedRanking &judged)
{
    program::Json json, intervals;
    for (const eval::RankingMetric &metric : eval::ranking_metrics) {
        const eval::Mean mean = judged.of(metric.value);
        json[metric.key] = mean.value;
        intervals[metric.key] = {mean.low, mean.high};
    }
    json["intervals"] = intervals;
    return json;
}

program::Json json_of(const eval::Evaluation &evaluation,
                      const std::vector<eval::Ablation> &ablations)
{
    const vdna_backbone_info &backbone = evaluation.backbone;
    program::Json json = {
        {"backbone", backbone.identity.backbone},
        {"model_sha256", backbone.identity.model_sha256},
        {"precision", vdna_identity_precision(&backbone.identity)},
        {"taps", backbone.identity.taps},
        {"runtime", backbone.runtime},
        {"dataset", evaluation.dataset},
        {"bins", evaluation.bins},
        {"warmup", warmup_of(evaluation)},
        {"tolerance", evaluation.tolerance},
        {"unit", name_of(evaluation.unit)},
        {"stride", evaluation.stride},
        {"cached", evaluation.cached},
        {"computed", evaluation.computed},
        {"queries", names_of_queries(evaluation)},
        {"frames", frames_of(evaluation)},
        {"methods", methods_of(evaluation.methods)},
        {"note", left_out_text(evaluation.methods.front().judged.metrics)},
        {"queries_that_rank_nothing", queries_that_rank_nothing(evaluation)},
        {"recall", outcomes_of(evaluation, [](const eval::Outcome &o) { return o.recall[0]; })}};
    for (size_t i = 1; i < eval::recall_depths.size(); i++)
        json["recall_at"][std::to_string(eval::recall_depths[i])] =
            outcomes_of(evaluation, [&](const eval::Outcome &o) { return o.recall[i]; });
    json["counts"] = outcomes_of(evaluation, counts_of);
    for (const eval::MethodResult &method : evaluation.methods)
        if (!method.distance.empty())
            json["distance"][method.name] = distances_of(evaluation, method);
    json["localisers"] = localisers_json(evaluation);
    if (!evaluation.drives.empty())
        json["drives"] = drives_json(evaluation);
    if (evaluation.reselection)
        json["reselection"] = reselection_json(evaluation);
    if (evaluation.trust)
        json["trust"] = trust_json(evaluation);
    for (const eval::Ablation &ablation : ablations) {
        program::Json &rows = json["ablations"][ablation.kind] = program::Json::array();
        for (const eval::AblationRow &row : ablation.rows)
            rows.push_back({{"value", row.value}, {"methods", methods_of(row.methods)}});
    }
    return json;
}

std::string csv_of(const eval::Evaluation &evaluation)
{
    std::string csv = "query,reference,recall_percent,good,total,unreachable";
    for (const eval::MethodResult &method : evaluation.methods)
        if (!method.distance.empty())
            csv += "," + csv_field("distance_" + method.name);
    for (const size_t i : beyond_usual_localisers(evaluation))
        csv += "," + csv_field("recall_percent_" + evaluation.localisers[i].name);
    for (size_t i = 0; evaluation.trust && i < prediction_heads.size(); i++)
        csv += "," + prediction_heads[i] + "_percent";
    csv += ",without_truth,note\n";
    const std::vector<LocaliserRow> rows = localiser_rows(evaluation);
    auto row = rows.begin();
    const size_t columns = evaluation.references.size();
    size_t predicted = 0;
    for (size_t q = 0; q < evaluation.queries.size(); q++) {
        const eval::QueryResult &query = evaluation.queries[q];
        const std::string &name = name_of(evaluation, query.traversal);
        auto pair = query.pairs.begin();
        for (size_t r = 0; r < columns; r++) {
            const size_t cell = q * columns + r;
            if (std::isnan(evaluation.recall[cell]))
                continue;
            csv += csv_row(name, name_of(evaluation, pair->reference), pair->outcome);
            for (const eval::MethodResult &method : evaluation.methods)
                if (!method.distance.empty())
                    csv += "," + program::Json(method.distance[cell]).dump();
            csv += localiser_cells(evaluation, *row++);
            if (evaluation.trust)
                csv += prediction_columns(evaluation.trust->pairs[predicted++]);
            csv += end_of_row(pair->outcome, "");
            ++pair;
        }
        csv += csv_row(name, "all", query.all);
        for (const eval::MethodResult &method : evaluation.methods)
            csv += method.distance.empty() ? "" : ",";
        csv += localiser_cells(evaluation, *row++) +
               std::string(evaluation.trust ? prediction_heads.size() : 0, ',') +
               end_of_row(query.all, eval::truth_ranks(evaluation, q) ? "" : ranks_nothing);
    }
    return csv;
}

} // namespace vdna::report
