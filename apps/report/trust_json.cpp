#include <vdna/trust.h>

#include "eval/methods.hpp"
#include "report/trust.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

// 3, 4 or "all".
program::Json count_of(uint32_t references)
{
    return references == 0 ? program::Json("all") : program::Json(references);
}

program::Json json_of(const eval::Mean &mean)
{
    return {{"mean", mean.value}, {"low", mean.low}, {"high", mean.high}};
}

program::Json json_of(const eval::TrustRanking &r)
{
    return {{"references", count_of(r.references)},
            {"method", r.method},
            {"truth", r.truth},
            {"ranking_error_swap_once", json_of(r.error)},
            {"regret", json_of(r.regret)},
            {"recall", json_of(r.recall)}};
}

program::Json json_of(const eval::PredictionScore &s)
{
    program::Json json = {
        {"references", count_of(s.references)},
        {"warmup", s.frames == 0 ? program::Json("full") : program::Json(s.frames)},
        {"maps", s.maps},
        {"predictions", s.predictions},
        {"error", json_of(s.error)},
        {"error_constant", json_of(s.error_constant)},
        {"error_nearest", json_of(s.error_nearest)},
        {"error_transfer", json_of(s.error_transfer)},
        {"coverage_percent", json_of(s.coverage)},
        {"width", json_of(s.width)},
        {"skill", json_of(s.skill)}};
    json["withheld"] = program::Json::object();
    for (uint32_t reason = 1; reason < s.withheld.size(); reason++)
        if (s.withheld[reason] > 0)
            json["withheld"][vdna_trust_reason_text(reason)] = s.withheld[reason];
    for (const eval::PredictedBin &bin : s.reliability)
        json["reliability"].push_back({{"predictions", bin.predictions},
                                       {"predicted", bin.predicted},
                                       {"achieved", json_of(bin.achieved)}});
    return json;
}

program::Json json_of(const eval::UnlikeScore &s)
{
    return {{"live", s.live},
            {"references", count_of(s.references)},
            {"maps", s.maps},
            {"unlike_percent", json_of(s.unlike)},
            {"best_where_unlike", json_of(s.best_where_unlike)},
            {"best_where_not", json_of(s.best_where_like)}};
}

program::Json json_of(const eval::SettledScore &s)
{
    return {{"references", count_of(s.references)},  {"maps", s.maps},
            {"settled_percent", json_of(s.settled)}, {"same_choice_percent", json_of(s.same)},
            {"frames_percent", json_of(s.frames)},   {"recall_lost", json_of(s.loss)},
            {"recall_lost_worst", s.worst_loss}};
}

template <typename Score>
program::Json array_of(const std::vector<Score> &scores)
{
    program::Json json = program::Json::array();
    for (const Score &score : scores)
        json.push_back(json_of(score));
    return json;
}

program::Json pair_json(const eval::TrustPair &pair)
{
    const std::vector<double> cells = prediction_cells(pair);
    program::Json json;
    for (size_t i = 0; i < cells.size(); i++)
        json[prediction_heads[i]] = cells[i];
    json["reason"] = vdna_trust_reason_text(pair.reason);
    return json;
}

} // namespace

const std::vector<std::string> prediction_heads = {"achieved", "predicted", "low",     "high",
                                                   "constant", "nearest",   "transfer"};

std::vector<double> prediction_cells(const eval::TrustPair &pair)
{
    return {pair.achieved, pair.predicted, pair.low,     pair.high,
            pair.constant, pair.nearest,   pair.transfer};
}

program::Json trust_json(const eval::Evaluation &evaluation)
{
    const eval::TrustEvaluation &trust = *evaluation.trust;
    program::Json json = {{"truth", trust.truth},
                          {"rankings", array_of(trust.rankings)},
                          {"predictions", array_of(trust.predictions)},
                          {"unlike", array_of(trust.unlike)},
                          {"settled", array_of(trust.settled)}};
    for (const eval::TrustPair &pair : trust.pairs)
        json["pairs"][name_of(evaluation, evaluation.queries[pair.query].traversal)]
            [name_of(evaluation, pair.reference)] = pair_json(pair);
    return json;
}

} // namespace vdna::report
