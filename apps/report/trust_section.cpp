// Trust in the choice: tables, and how reliable predictions are.
#include <cmath>

#include <vdna/trust.h>

#include "report/chart.hpp"
#include "report/html.hpp"
#include "report/sections.hpp"
#include "report/trust.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

std::string head_of(const std::vector<std::string> &titles)
{
    std::string html;
    for (const std::string &title : titles)
        html += text_element("th scope=\"col\"", title);
    return element("tr", html);
}

std::string html_of(const TrustTable &shown)
{
    std::string body;
    for (const std::vector<std::string> &row : shown.rows) {
        std::string cells;
        for (size_t i = 0; i < row.size(); i++)
            cells += text_element(i < shown.names ? "td" : "td class=\"number\"", row[i]);
        body += element("tr", cells);
    }
    return table(escaped(shown.title), head_of(shown.heads), body);
}

Figure reliability_chart(const eval::PredictionScore &score)
{
    std::vector<Point> points;
    for (const eval::PredictedBin &bin : score.reliability)
        if (bin.predictions > 0)
            points.push_back({bin.predicted, bin.achieved.value, 0,
                              std::to_string(bin.predictions) + " predictions, mean " +
                                  number_text(bin.predicted, 1) + " %, achieved " +
                                  mean_text(bin.achieved) + " %",
                              bin.achieved.low, bin.achieved.high});
    const std::string references = score.references == 0 ? "all" : std::to_string(score.references);
    const std::string warmup =
        score.frames == 0 ? "full warmup" : std::to_string(score.frames) + " frames of warmup";
    Figure chart = diagonal_chart("predicted recall, %", 100, "achieved, %", 100, points);
    chart.name = "predictions-" + references + "-" +
                 (score.frames == 0 ? "full" : std::to_string(score.frames));
    chart.caption = "Maps of " + references + " references, " + warmup + ": mean error " +
                    mean_text(score.error) + ". Lines: 95 % intervals.";
    return chart;
}

std::string pairs_table(const eval::Evaluation &evaluation)
{
    std::vector<std::string> titles = {"Query", "Reference"};
    titles.insert(titles.end(), prediction_heads.begin(), prediction_heads.end());
    titles.emplace_back("Withheld because");
    std::string body;
    for (const eval::TrustPair &pair : evaluation.trust->pairs) {
        std::string cells =
            text_element("th scope=\"row\"",
                         name_of(evaluation, evaluation.queries[pair.query].traversal)) +
            text_element("td", name_of(evaluation, pair.reference));
        for (const double value : prediction_cells(pair))
            cells += text_element("td class=\"number\"", number_text(value, 2));
        body += element("tr", cells + text_element("td", vdna_trust_reason_text(pair.reason)));
    }
    return foldable("Every query in every reference", false,
                    table("Recall@1 in %, achieved and predicted in maps of all references",
                          head_of(titles), body));
}

} // namespace

std::vector<Figure> trust_figures(const eval::Evaluation &evaluation)
{
    std::vector<Figure> figures;
    if (evaluation.trust)
        for (const eval::PredictionScore &score : evaluation.trust->predictions)
            figures.push_back(reliability_chart(score));
    return figures;
}

std::string trust_section(const eval::Evaluation &evaluation)
{
    if (!evaluation.trust)
        return "";
    std::string tables;
    for (const TrustTable &shown : trust_tables(*evaluation.trust))
        tables += html_of(shown);
    return "<h2>Trust in the choice</h2>" + text_element("p", trust_summary(*evaluation.trust)) +
           charts(trust_figures(evaluation)) + tables + pairs_table(evaluation) +
           text_element("p", trust_explanation);
}

} // namespace vdna::report
