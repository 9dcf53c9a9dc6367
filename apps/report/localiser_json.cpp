#include <cmath>

#include "report/localisers.hpp"

namespace vdna::report
{

namespace
{

program::Json json_of(const eval::Mean &mean)
{
    return {{"recall", mean.value}, {"low", mean.low}, {"high", mean.high}};
}

program::Json json_of(const eval::ConfidenceMetrics &metrics)
{
    program::Json json = {
        {"answers", metrics.answers}, {"good", metrics.good}, {"auroc", metrics.auroc}};
    for (const eval::ReliabilityBin &bin : metrics.reliability)
        json["reliability"].push_back({{"answers", bin.answers},
                                       {"confidence", bin.confidence},
                                       {"good_percent", bin.good_percent}});
    for (const eval::Threshold &threshold : metrics.thresholds)
        json["thresholds"].push_back({{"confidence", threshold.confidence},
                                      {"precision_percent", threshold.precision},
                                      {"kept_percent", threshold.kept},
                                      {"answered_percent", threshold.answered}});
    return json;
}

program::Json json_of(const eval::LocaliserScore &score)
{
    program::Json json = json_of(score.recall);
    if (score.confidence)
        json["confidence"] = json_of(*score.confidence);
    if (score.off_route)
        json["off_route"] = {{"confidence", eval::usual_min_confidence},
                             {"answered_percent", score.off_route->value},
                             {"low", score.off_route->low},
                             {"high", score.off_route->high}};
    return json;
}

program::Json json_of(const eval::LocaliserResult &result)
{
    return {{"mean", json_of(result.mean)}, {"first_choice", json_of(result.chosen)}};
}

} // namespace

program::Json localisers_json(const eval::Evaluation &evaluation)
{
    const std::vector<LocaliserRow> rows = localiser_rows(evaluation);
    program::Json json = program::Json::object();
    for (size_t i = 0; i < evaluation.localisers.size(); i++) {
        const eval::LocaliserResult &result = evaluation.localisers[i];
        program::Json &entry = json[result.name];
        entry = json_of(result);
        for (const LocaliserRow &row : rows)
            if (!std::isnan(row.recall[i]))
                entry["recall"][row.query][row.reference] = row.recall[i];
    }
    return json;
}

program::Json drives_json(const eval::Evaluation &evaluation)
{
    program::Json json = program::Json::object();
    for (const eval::LocaliserResult &result : evaluation.drives)
        json[result.drive][result.name] = json_of(result);
    return json;
}

} // namespace vdna::report
