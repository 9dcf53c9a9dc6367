#include <algorithm>
#include <cmath>

#include <vdna/trust.h>

#include "program/text_table.hpp"
#include "report/trust.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

std::string count_text(uint32_t references)
{
    return references == 0 ? "all" : std::to_string(references);
}

std::string number(double value)
{
    return std::isnan(value) ? "-" : program::fixed(value, 2);
}

// Of the predictions that were withheld: "unlike 3, few runs 1".
std::string withheld_text(const eval::PredictionScore &score)
{
    static const char *const reasons[] = {"",         "no tables",    "few frames", "unlike",
                                          "few runs", "not labelled", "no distance"};
    std::string text;
    for (size_t i = 1; i < score.withheld.size(); i++)
        if (score.withheld[i] > 0)
            text += (text.empty() ? "" : ", ") + std::string(reasons[i]) + " " +
                    std::to_string(score.withheld[i]);
    return text.empty() ? "0" : text;
}

TrustTable rankings_table(const eval::TrustEvaluation &trust, const std::string &truth)
{
    TrustTable table = {
        "Rankings, judged by Recall@1 of the localiser " + truth,
        {"references", "method", "ranking error/%", "regret/%", "recall in the first choice/%"},
        {},
        2};
    for (const eval::TrustRanking &ranking : trust.rankings)
        if (ranking.truth == truth)
            table.rows.push_back({count_text(ranking.references), ranking.method,
                                  mean_text(ranking.error), mean_text(ranking.regret),
                                  mean_text(ranking.recall)});
    return table;
}

std::string frames_text(const eval::PredictionScore &score)
{
    return score.frames == 0 ? "full" : std::to_string(score.frames) + " frames";
}

TrustTable errors_table(const eval::TrustEvaluation &trust)
{
    TrustTable table = {
        "Predicted recall of the localiser " + trust.truth +
            ": mean error in percentage points, beside that of other predictors",
        {"references", "warmup", "predictions", "error", "constant", "nearest", "transfer"},
        {},
        2};
    for (const eval::PredictionScore &s : trust.predictions)
        table.rows.push_back({count_text(s.references), frames_text(s),
                              std::to_string(s.predictions), mean_text(s.error),
                              mean_text(s.error_constant), mean_text(s.error_nearest),
                              mean_text(s.error_transfer)});
    return table;
}

TrustTable intervals_table(const eval::TrustEvaluation &trust)
{
    TrustTable table = {
        "80 % intervals of predicted recall, skill of the maps, predictions that were withheld",
        {"references", "warmup", "maps", "cover/%", "width/%", "skill", "withheld"},
        {},
        2};
    for (const eval::PredictionScore &s : trust.predictions)
        table.rows.push_back({count_text(s.references), frames_text(s), std::to_string(s.maps),
                              mean_text(s.coverage), mean_text(s.width), mean_text(s.skill),
                              withheld_text(s)});
    return table;
}

TrustTable reliability_table(const eval::PredictionScore &score)
{
    TrustTable table = {"Reliability of predictions, maps of all references, full warmup",
                        {"predicted/%", "predictions", "mean", "achieved/%"},
                        {},
                        1};
    for (size_t i = 0; i < score.reliability.size(); i++) {
        const eval::PredictedBin &bin = score.reliability[i];
        if (bin.predictions > 0)
            table.rows.push_back({"from " + std::to_string(10 * i), std::to_string(bin.predictions),
                                  number(bin.predicted), mean_text(bin.achieved)});
    }
    return table;
}

TrustTable unlike_table(const eval::TrustEvaluation &trust)
{
    TrustTable table = {
        "Live runs said to be unlike all of the map; best recall in it where so, and where not",
        {"live run", "references", "maps", "unlike/%", "best where unlike/%", "best where not/%"},
        {},
        2};
    for (const eval::UnlikeScore &s : trust.unlike)
        table.rows.push_back({s.live, count_text(s.references), std::to_string(s.maps),
                              mean_text(s.unlike), mean_text(s.best_where_unlike),
                              mean_text(s.best_where_like)});
    return table;
}

TrustTable settled_table(const eval::TrustEvaluation &trust)
{
    TrustTable table = {"Warmups that end when the choice has settled, against full ones",
                        {"references", "maps", "ended early/%", "same choice/%", "frames/%",
                         "recall lost/%", "at worst/%"},
                        {},
                        1};
    for (const eval::SettledScore &s : trust.settled)
        table.rows.push_back({count_text(s.references), std::to_string(s.maps),
                              mean_text(s.settled), mean_text(s.same), mean_text(s.frames),
                              mean_text(s.loss), number(s.worst_loss)});
    return table;
}

} // namespace

std::string trust_summary(const eval::TrustEvaluation &trust)
{
    for (const eval::PredictionScore &score : trust.predictions) {
        if (score.references != 0 || score.frames != 0)
            continue;
        if (!std::isfinite(score.error.value))
            return "In maps of all references nothing is predicted: the tables say why.";
        const bool helps = score.error.value < score.error_constant.value;
        return "In maps of all references, recall is predicted to " +
               program::fixed(score.error.value, 1) + " points on average, " +
               (helps ? "closer" : "no closer") + " than by a reference's mean (" +
               program::fixed(score.error_constant.value, 1) + "), and " +
               program::fixed(score.coverage.value, 0) + " % lie in their 80 % intervals.";
    }
    return "";
}

const char *const trust_explanation =
    "Each query is tried in maps of its references: of all, and of 3 and 4 drawn from them. What a "
    "map knows about itself is made of its own drives alone. Means are over queries, in brackets "
    "their 95 % intervals.";

std::vector<TrustTable> trust_tables(const eval::TrustEvaluation &trust)
{
    std::vector<TrustTable> tables = {rankings_table(trust, trust.truth),
                                      rankings_table(trust, "filter"), errors_table(trust),
                                      intervals_table(trust)};
    for (const eval::PredictionScore &score : trust.predictions)
        if (score.references == 0 && score.frames == 0)
            tables.push_back(reliability_table(score));
    tables.push_back(unlike_table(trust));
    tables.push_back(settled_table(trust));
    return tables;
}

std::string trust_text(const eval::TrustEvaluation &trust)
{
    std::string text =
        "\nTrust in the choice. " + trust_summary(trust) + "\n" + trust_explanation + "\n";
    for (const TrustTable &shown : trust_tables(trust)) {
        program::TextTable table;
        table.add_row(shown.heads);
        for (const std::vector<std::string> &row : shown.rows)
            table.add_row(row);
        text += "\n" + shown.title + "\n" + table.text();
    }
    return text;
}

} // namespace vdna::report
