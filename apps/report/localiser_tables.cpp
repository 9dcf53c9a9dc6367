#include <algorithm>
#include <cmath>
#include <limits>

#include "eval/localisers.hpp"
#include "program/text_table.hpp"
#include "report/localisers.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

constexpr double other_map = std::numeric_limits<double>::quiet_NaN();

// reference: its column, or one past the last for all at once.
LocaliserRow row_of(const eval::Evaluation &evaluation, size_t query, size_t reference)
{
    const size_t columns = evaluation.references.size();
    LocaliserRow row{name_of(evaluation, evaluation.queries[query].traversal),
                     reference == columns ? "all"
                                          : name_of(evaluation, evaluation.references[reference]),
                     {}};
    for (const eval::LocaliserResult &result : evaluation.localisers)
        row.recall.push_back(result.in_each != (reference < columns) ? other_map
                             : result.in_each ? result.recall[query * columns + reference]
                                              : result.recall[query]);
    return row;
}

std::string percent_text(double value)
{
    return std::isnan(value) ? "-" : program::fixed(value, 2);
}

std::string means_table(const eval::Evaluation &evaluation)
{
    program::TextTable table;
    table.add_row({"localiser", "mean over references", "in the first choice"});
    for (const eval::LocaliserResult &result : evaluation.localisers)
        table.add_row(
            {result.name, mean_text(result.mean.recall), mean_text(result.chosen.recall)});
    return table.text();
}

std::string recall_table(const eval::Evaluation &evaluation)
{
    program::TextTable table;
    table.add_row({"query", "reference"});
    for (const eval::LocaliserResult &result : evaluation.localisers)
        table.add(result.name);
    for (const LocaliserRow &row : localiser_rows(evaluation)) {
        table.add_row({row.query, row.reference});
        for (const double recall : row.recall)
            table.add(std::isnan(recall) ? "" : program::fixed(recall, 2));
    }
    return table.text();
}

std::string confidence_tables(const eval::LocaliserResult &result)
{
    const eval::ConfidenceMetrics &metrics = *result.mean.confidence;
    program::TextTable curve, thresholds;
    curve.add_row({"confidence", "answers", "mean", "good/%"});
    for (size_t i = 0; i < metrics.reliability.size(); i++) {
        const eval::ReliabilityBin &bin = metrics.reliability[i];
        curve.add_row({"from " + program::fixed(0.1 * static_cast<double>(i), 1),
                       std::to_string(bin.answers), percent_text(bin.confidence),
                       percent_text(bin.good_percent)});
    }
    thresholds.add_row({"at least", "precision/%", "good ones kept/%", "answered/%"});
    for (const eval::Threshold &threshold : metrics.thresholds)
        thresholds.add_row({program::fixed(threshold.confidence, 2),
                            percent_text(threshold.precision), percent_text(threshold.kept),
                            percent_text(threshold.answered)});
    return "\nConfidence of " + result.name + ": AUROC " +
           (std::isnan(metrics.auroc) ? "-" : program::fixed(metrics.auroc, 3)) + ", " +
           std::to_string(metrics.answers) + " answers, " + std::to_string(metrics.good) +
           " good\n" + curve.text() + "\n" + thresholds.text();
}

// references: those of the score.
std::vector<std::string> drive_row(const eval::LocaliserResult &result,
                                   const std::string &references, const eval::LocaliserScore &score)
{
    std::vector<std::string> row = {result.drive, result.name, references, mean_text(score.recall)};
    if (score.confidence) {
        const eval::Threshold &usual = eval::usual_threshold(*score.confidence);
        const double auroc = score.confidence->auroc;
        row.push_back(std::isnan(auroc) ? "-" : program::fixed(auroc, 3));
        row.push_back(percent_text(usual.precision));
        row.push_back(percent_text(usual.kept));
    }
    if (score.off_route)
        row.push_back(mean_text(*score.off_route));
    return row;
}

std::string drives_table(const eval::Evaluation &evaluation)
{
    program::TextTable table;
    table.add_row(drive_heads);
    for (const std::vector<std::string> &row : drive_rows(evaluation))
        table.add_row(row);
    return "\nDrives: Recall@1 of the frames on the route; precision, right answers kept and "
           "frames "
           "answered off the route at a confidence of at least " +
           program::fixed(eval::usual_min_confidence, 2) + "\n" + table.text();
}

} // namespace

std::vector<LocaliserRow> localiser_rows(const eval::Evaluation &evaluation)
{
    std::vector<LocaliserRow> rows;
    const size_t columns = evaluation.references.size();
    for (size_t query = 0; query < evaluation.queries.size(); query++) {
        for (size_t reference = 0; reference < columns; reference++)
            if (!std::isnan(evaluation.recall[query * columns + reference]))
                rows.push_back(row_of(evaluation, query, reference));
        rows.push_back(row_of(evaluation, query, columns));
    }
    return rows;
}

const std::vector<std::string> drive_heads = {
    "drive", "localiser",   "references", "Recall@1/%",
    "AUROC", "precision/%", "kept/%",     "answered off route/%",
};

std::vector<std::vector<std::string>> drive_rows(const eval::Evaluation &evaluation)
{
    std::vector<std::vector<std::string>> rows;
    for (const eval::LocaliserResult &result : evaluation.drives) {
        rows.push_back(drive_row(result, result.in_each ? "each" : "together", result.mean));
        if (result.in_each)
            rows.push_back(drive_row(result, "first choice", result.chosen));
    }
    return rows;
}

std::vector<size_t> beyond_usual_localisers(const eval::Evaluation &evaluation)
{
    const std::vector<std::string> &usual = eval::usual_localisers;
    std::vector<size_t> beyond;
    for (size_t i = 0; i < evaluation.localisers.size(); i++)
        if (std::find(usual.begin(), usual.end(), evaluation.localisers[i].name) == usual.end())
            beyond.push_back(i);
    return beyond;
}

std::string localiser_tables(const eval::Evaluation &evaluation)
{
    std::string text = "Localisers, Recall@1 in percent; in brackets the 95 % interval over " +
                       std::to_string(evaluation.queries.size()) + " queries\n" +
                       means_table(evaluation);
    if (!beyond_usual_localisers(evaluation).empty())
        text += "\n" + recall_table(evaluation);
    for (const eval::LocaliserResult &result : evaluation.localisers)
        if (result.mean.confidence)
            text += confidence_tables(result);
    return text + (evaluation.drives.empty() ? "" : drives_table(evaluation));
}

} // namespace vdna::report
