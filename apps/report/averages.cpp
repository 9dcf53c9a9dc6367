// Error tables of all methods and of the ablations.
#include <cmath>

#include "eval/methods.hpp"
#include "report/html.hpp"
#include "report/sections.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

std::string cell(const eval::Mean &mean)
{
    const std::string interval =
        std::isnan(mean.low) ? ""
                             : "<br>" + text_element("small", number_text(mean.low, 3) + " to " +
                                                                  number_text(mean.high, 3));
    return element("td class=\"number\"", escaped(number_text(mean.value, 3)) + interval);
}

std::string row_of(const eval::MethodResult &method)
{
    std::string cells;
    for (const eval::RankingMetric &metric : eval::ranking_metrics)
        cells += cell(method.judged.of(metric.value));
    return element(method.name == eval::methods.front().key ? "tr class=\"ours\"" : "tr",
                   text_element("th scope=\"row\"", eval::title_of(method.name)) + cells);
}

std::string header_cells(const std::vector<std::string> &titles)
{
    std::string html;
    for (const std::string &title : titles)
        html += text_element("th scope=\"col\"", title);
    return html;
}

std::string table_of(const eval::Ablation &ablation)
{
    std::vector<std::string> titles = {ablation.kind};
    for (const eval::MethodResult &method : ablation.rows.front().methods)
        if (!eval::is_of_tap(method.name)) // many taps would need too many columns
            titles.insert(titles.end(), {eval::title_of(method.name) + ": error, %", "regret, %"});
    std::string body;
    for (const eval::AblationRow &row : ablation.rows) {
        std::string cells;
        for (const eval::MethodResult &method : row.methods)
            if (!eval::is_of_tap(method.name))
                cells += cell(method.judged.of(&vdna_ranking_metrics::ranking_error_swap_once)) +
                         cell(method.judged.of(&vdna_ranking_metrics::regret));
        body += element("tr", text_element("th scope=\"row\"", row.value) + cells);
    }
    return table("Ablation: " + escaped(ablation.kind), element("tr", header_cells(titles)), body);
}

} // namespace

std::string averages_section(const eval::Evaluation &evaluation)
{
    std::string body;
    for (const eval::MethodResult &method : evaluation.methods)
        body += row_of(method);
    std::vector<std::string> titles = {"Method"};
    for (const eval::RankingMetric &metric : eval::ranking_metrics)
        titles.emplace_back(metric.title);
    const std::string left_out = left_out_text(evaluation.methods.front().judged.metrics);
    return "<h2>How well each method ranks</h2>" +
           table("Ranking errors, averaged over queries, with 95 % intervals",
                 element("tr", header_cells(titles)), body) +
           (left_out.empty() ? "" : text_element("p", left_out));
}

std::string ablations_section(const std::vector<eval::Ablation> &ablations)
{
    if (ablations.empty())
        return "";
    std::string html = "<h2>Ablations</h2>";
    for (const eval::Ablation &ablation : ablations)
        html += table_of(ablation);
    return html;
}

} // namespace vdna::report
