// Averages over queries, with their intervals, as CSV.
#include <cmath>

#include "report/csv_field.hpp"
#include "report/result_json.hpp"

namespace vdna::report
{

namespace
{

class AveragesCsv
{
  public:
    void add(const std::string &table, const std::string &row, const std::string &average,
             const eval::Mean &mean)
    {
        text_ += csv_field(table) + "," + csv_field(row) + "," + average;
        for (const double value : {mean.value, mean.low, mean.high})
            text_ += "," + (std::isnan(value) ? "" : program::Json(value).dump());
        text_ += "\n";
    }

    void add(const std::string &table, const std::string &row, const eval::JudgedRanking &judged)
    {
        for (const eval::RankingMetric &metric : eval::ranking_metrics)
            add(table, row, metric.key, judged.of(metric.value));
    }

    void add(const std::string &table, const eval::LocaliserResult &result)
    {
        add(table, result.name, "recall_percent", result.mean.recall);
        add(table, result.name, "recall_percent_first_choice", result.chosen.recall);
        if (result.mean.off_route)
            add(table, result.name, "answered_off_route_percent", *result.mean.off_route);
    }

    void add(const eval::Reselection &reselection)
    {
        const std::string table = "choosing again";
        add(table, "mean", "again_percent", reselection.again);
        add(table, "mean", "never_percent", reselection.never);
        add(table, "mean", "best_percent", reselection.best);
        add(table, "mean", "gain", reselection.gain);
    }

    void add(const eval::TrustEvaluation &trust)
    {
        for (const eval::TrustRanking &ranking : trust.rankings) {
            const std::string table = "trust, judged by " + ranking.truth;
            const std::string row = references_text(ranking.references) + ", " + ranking.method;
            add(table, row, "ranking_error_swap_once", ranking.error);
            add(table, row, "regret", ranking.regret);
            add(table, row, "recall_percent_first_choice", ranking.recall);
        }
        for (const eval::PredictionScore &score : trust.predictions) {
            const std::string row =
                references_text(score.references) + ", " +
                (score.frames == 0 ? "full" : std::to_string(score.frames) + " frames");
            add("predictions", row, "error", score.error);
            add("predictions", row, "error_constant", score.error_constant);
            add("predictions", row, "error_nearest", score.error_nearest);
            add("predictions", row, "error_transfer", score.error_transfer);
            add("predictions", row, "coverage_percent", score.coverage);
            add("predictions", row, "width", score.width);
            add("predictions", row, "skill", score.skill);
        }
        for (const eval::UnlikeScore &score : trust.unlike)
            add("unlike", references_text(score.references) + ", " + score.live, "unlike_percent",
                score.unlike);
        for (const eval::SettledScore &score : trust.settled) {
            const std::string row = references_text(score.references);
            add("settled", row, "settled_percent", score.settled);
            add("settled", row, "same_choice_percent", score.same);
            add("settled", row, "frames_percent", score.frames);
            add("settled", row, "recall_lost", score.loss);
        }
    }

    const std::string &text() const { return text_; }

  private:
    // "3 references"
    static std::string references_text(uint32_t references)
    {
        return (references == 0 ? "all" : std::to_string(references)) + " references";
    }

    std::string text_ = "table,row,average,value,low,high\n";
};

} // namespace

std::string averages_csv_of(const eval::Evaluation &evaluation,
                            const std::vector<eval::Ablation> &ablations)
{
    AveragesCsv csv;
    for (const eval::MethodResult &method : evaluation.methods)
        csv.add("ranking", method.name, method.judged);
    for (const eval::LocaliserResult &result : evaluation.localisers)
        csv.add("localisers", result);
    for (const eval::LocaliserResult &result : evaluation.drives)
        csv.add("drive " + result.drive, result);
    if (evaluation.reselection)
        csv.add(*evaluation.reselection);
    if (evaluation.trust)
        csv.add(*evaluation.trust);
    for (const eval::Ablation &ablation : ablations)
        for (const eval::AblationRow &row : ablation.rows)
            for (const eval::MethodResult &method : row.methods)
                csv.add("ablation " + ablation.kind, row.value + " " + method.name, method.judged);
    return csv.text();
}

} // namespace vdna::report
