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

} // namespace

program::Json localisers_json(const eval::Evaluation &evaluation)
{
    const std::vector<LocaliserRow> rows = localiser_rows(evaluation);
    program::Json json = program::Json::object();
    for (size_t i = 0; i < evaluation.localisers.size(); i++) {
        const eval::LocaliserResult &result = evaluation.localisers[i];
        program::Json &entry = json[result.name];
        entry["mean"] = json_of(result.mean);
        entry["first_choice"] = json_of(result.chosen);
        for (const LocaliserRow &row : rows)
            if (!std::isnan(row.recall[i]))
                entry["recall"][row.query][row.reference] = row.recall[i];
        if (result.confidence)
            entry["confidence"] = json_of(*result.confidence);
    }
    return json;
}

} // namespace vdna::report
