// Error tables of all methods and of the ablations.
#include "eval/methods.hpp"
#include "report/html.hpp"
#include "report/sections.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

std::string cells(const std::vector<double> &values)
{
    std::string html;
    for (const double value : values)
        html += text_element("td class=\"number\"", number_text(value, 3));
    return html;
}

std::string row_of(const eval::MethodResult &method)
{
    const vdna_ranking_metrics &m = method.metrics;
    return element(
        method.name == eval::methods.front().key ? "tr class=\"ours\"" : "tr",
        text_element("th scope=\"row\"", eval::title_of(method.name)) +
            cells({m.ranking_error_swap_once, m.ranking_error_half_l1, m.regret, m.kendall_tau,
                   m.pearson_within, m.spearman_within, m.pearson_pooled, m.spearman_pooled}));
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
        std::vector<double> values;
        for (const eval::MethodResult &method : row.methods)
            if (!eval::is_of_tap(method.name))
                values.insert(values.end(),
                              {method.metrics.ranking_error_swap_once, method.metrics.regret});
        body += element("tr", text_element("th scope=\"row\"", row.value) + cells(values));
    }
    return table("Ablation: " + escaped(ablation.kind), element("tr", header_cells(titles)), body);
}

} // namespace

std::string averages_section(const eval::Evaluation &evaluation)
{
    const std::string explanation =
        "<p>Errors are in percentage points of Recall@1, averaged over all queries; lower is "
        "better. <b>Swap-once</b> is the paper's ranking error: each pair of swapped "
        "references costs the difference of their recalls. <b>Half-L1</b> is "
        "half of the recall difference summed over all ranks. <b>Regret</b> is the recall lost by "
        "taking the first choice instead of the best. <b>Kendall tau</b> is 1 for the true order "
        "and -1 for its reverse. The <b>correlations</b> of distance and recall are best at -1: "
        "the nearer, the better; \"within\" is within each query, \"pooled\" over all.</p>";
    std::string body;
    for (const eval::MethodResult &method : evaluation.methods)
        body += row_of(method);
    const std::string left_out = left_out_text(evaluation.methods.front().metrics);
    return "<h2>How well each method ranks</h2>" + explanation +
           (left_out.empty() ? "" : text_element("p", left_out)) +
           table("Ranking errors, averaged",
                 element("tr", header_cells({"Method", "Swap-once, %", "Half-L1, %", "Regret, %",
                                             "Kendall tau", "Pearson within", "Spearman within",
                                             "Pearson pooled", "Spearman pooled"})),
                 body);
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
