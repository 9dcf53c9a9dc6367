// The localisers side by side: means with intervals, recalls, confidences.
#include "report/localisers.hpp"

#include <cmath>

#include "eval/drives.hpp"
#include "eval/localisers.hpp"
#include "report/chart.hpp"
#include "report/html.hpp"
#include "report/sections.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

std::string number_cell(const std::string &text)
{
    return text_element("td class=\"number\"", text);
}

std::string head_of(const std::vector<std::string> &titles)
{
    std::string html;
    for (const std::string &title : titles)
        html += text_element("th scope=\"col\"", title);
    return element("tr", html);
}

std::string means_table(const eval::Evaluation &evaluation)
{
    std::string body;
    for (const eval::LocaliserResult &result : evaluation.localisers)
        body += element(
            "tr", text_element("th scope=\"row\"", eval::localiser_of(result.name).title) +
                      text_element("td", result.name) + number_cell(mean_text(result.mean.recall)) +
                      number_cell(mean_text(result.chosen.recall)));
    return table("Localisers: Recall@1 in %, mean over queries, with 95 % intervals",
                 head_of({"Localiser", "Name", "Mean over references", "In the first choice"}),
                 body);
}

Figure means_chart(const eval::Evaluation &evaluation)
{
    std::vector<WhiskerGroup> groups;
    for (const eval::LocaliserResult &result : evaluation.localisers) {
        const auto whisker = [&](const eval::Mean &mean, const std::string &of) {
            return Whisker{mean.value, mean.low, mean.high,
                           result.name + ", " + of + ": " + mean_text(mean) + " %"};
        };
        groups.push_back({result.name,
                          {whisker(result.mean.recall, "mean over references"),
                           whisker(result.chosen.recall, "in the first choice")}});
    }
    Figure chart = whisker_chart("Recall@1, %", 100, groups);
    chart.name = "localisers";
    chart.caption = "Left: mean over references. Right: in the reference that Visual DNA chooses "
                    "first. Lines: 95 % intervals.";
    return chart;
}

std::string recall_table(const eval::Evaluation &evaluation)
{
    std::vector<std::string> titles = {"Query", "Reference"};
    for (const eval::LocaliserResult &result : evaluation.localisers)
        titles.push_back(result.name);
    std::string body;
    for (const LocaliserRow &row : localiser_rows(evaluation)) {
        std::string cells =
            text_element("th scope=\"row\"", row.query) + text_element("td", row.reference);
        for (const double recall : row.recall)
            cells += number_cell(std::isnan(recall) ? "" : number_text(recall, 2));
        body += element("tr", cells);
    }
    return foldable("Every query in every reference", false,
                    table("Recall@1 in % by localiser", head_of(titles), body));
}

Figure reliability_chart(const eval::LocaliserResult &result)
{
    const eval::ConfidenceMetrics &metrics = *result.mean.confidence;
    std::vector<Point> points;
    for (const eval::ReliabilityBin &bin : metrics.reliability)
        if (bin.answers > 0)
            points.push_back({bin.confidence, bin.good_percent, 0,
                              std::to_string(bin.answers) + " answers, mean confidence " +
                                  number_text(bin.confidence, 3) + ", " +
                                  number_text(bin.good_percent, 1) + " % good"});
    Figure chart = diagonal_chart("confidence", 1, "good answers, %", 100, points);
    chart.name = "confidence-" + result.name;
    chart.caption = std::string(eval::localiser_of(result.name).title) + ": AUROC " +
                    number_text(metrics.auroc, 3) + ", " + std::to_string(metrics.answers) +
                    " answers";
    return chart;
}

std::vector<Figure> reliability_charts(const eval::Evaluation &evaluation)
{
    std::vector<Figure> figures;
    for (const eval::LocaliserResult &result : evaluation.localisers)
        if (result.mean.confidence)
            figures.push_back(reliability_chart(result));
    return figures;
}

std::string threshold_table(const eval::LocaliserResult &result)
{
    std::string body;
    for (const eval::Threshold &threshold : result.mean.confidence->thresholds)
        body +=
            element("tr", text_element("th scope=\"row\"", number_text(threshold.confidence, 2)) +
                              number_cell(number_text(threshold.precision, 2)) +
                              number_cell(number_text(threshold.kept, 2)) +
                              number_cell(number_text(threshold.answered, 2)));
    return table("Answers of " + escaped(result.name) + " by their least confidence",
                 head_of({"At least", "Precision, %", "Good ones kept, %", "Answered, %"}), body);
}

std::string confidences(const eval::Evaluation &evaluation)
{
    const std::vector<Figure> figures = reliability_charts(evaluation);
    if (figures.empty())
        return "";
    std::string tables;
    for (const eval::LocaliserResult &result : evaluation.localisers)
        if (result.mean.confidence)
            tables += threshold_table(result);
    return "<h3>Confidence</h3>" + charts(figures) + tables;
}

std::string drives(const eval::Evaluation &evaluation)
{
    if (evaluation.drives.empty())
        return "";
    std::string body, list;
    for (std::vector<std::string> cells : drive_rows(evaluation)) {
        cells.resize(drive_heads.size());
        std::string row = text_element("th scope=\"row\"", cells[0]) +
                          text_element("td", cells[1]) + text_element("td", cells[2]);
        for (size_t i = 3; i < cells.size(); i++)
            row += number_cell(cells[i]);
        body += element("tr", row);
    }
    for (const eval::DriveKind &kind : eval::drive_kinds)
        list += text_element("dt", kind.key) + text_element("dd", kind.title);
    return "<h3>Disturbed drives</h3>" + table("Localisers by drive", head_of(drive_heads), body) +
           element("dl", list);
}

} // namespace

std::vector<Figure> localiser_figures(const eval::Evaluation &evaluation)
{
    std::vector<Figure> figures = reliability_charts(evaluation);
    figures.insert(figures.begin(), means_chart(evaluation));
    return figures;
}

std::string localisers_section(const eval::Evaluation &evaluation)
{
    return "<h2>How well each localiser finds the place</h2>" + charts({means_chart(evaluation)}) +
           means_table(evaluation) +
           (beyond_usual_localisers(evaluation).empty() ? "" : recall_table(evaluation)) +
           confidences(evaluation) + drives(evaluation);
}

} // namespace vdna::report
