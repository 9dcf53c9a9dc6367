#include "report/latex.hpp"

#include <algorithm>
#include <cmath>

#include "eval/localisers.hpp"
#include "eval/methods.hpp"
#include "eval/placing.hpp"
#include "program/print.hpp"
#include "report/html.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

const char *const preamble = "% Written by vdna eval. In the preamble of the document:\n"
                             "%   \\usepackage{booktabs,multirow,graphicx,subcaption}\n"
                             "%   \\usepackage[table]{xcolor}\n";

constexpr size_t columns_beside = 4;  // wider tables have a line of their own
constexpr size_t columns_natural = 4; // wider tables are scaled to the text's width

// Queries of one group: they have the same references but themselves.
struct Group {
    std::string name;
    std::vector<size_t> queries;
};

std::vector<Group> groups_of(const eval::Evaluation &evaluation)
{
    std::vector<Group> groups;
    for (size_t q = 0; q < evaluation.queries.size(); q++) {
        const std::string &name = (*evaluation.traversals)[evaluation.queries[q].traversal].group;
        const auto same = std::find_if(groups.begin(), groups.end(),
                                       [&](const Group &group) { return group.name == name; });
        if (same == groups.end())
            groups.push_back({name, {q}});
        else
            same->queries.push_back(q);
    }
    return groups;
}

// Cells of a row, with the end of it.
std::string row(const std::vector<std::string> &cells)
{
    std::string text;
    for (size_t i = 0; i < cells.size(); i++)
        text += (i > 0 ? " & " : "") + cells[i];
    return text + " \\\\\n";
}

std::string coloured(const eval::Place &place, const std::string &text)
{
    return place.off == 0   ? text
           : place.off == 1 ? "\\cellcolor{orange!25}" + text
                            : "\\cellcolor{red!25}" + text;
}

// A ranking of references below each query.
struct RankingTable {
    std::string head;    // above the queries, LaTeX
    std::string caption; // LaTeX
    std::vector<std::string> queries;
    std::vector<std::vector<std::string>> cells; // [queries][ranks], LaTeX
};

std::string latex_of(const RankingTable &table)
{
    const size_t columns = table.queries.size();
    size_t ranks = 1;
    for (const std::vector<std::string> &column : table.cells)
        ranks = std::max(ranks, column.size());
    std::string rules;
    for (size_t i = 2; i < columns + 2; i++)
        rules += "\\cmidrule(lr){" + std::to_string(i) + "-" + std::to_string(i) + "}";

    std::vector<std::string> head = {""};
    for (const std::string &query : table.queries)
        head.push_back(latex_escaped(query));
    std::string text =
        "\\begin{subtable}[h]{" + std::string(columns > columns_beside ? "" : "0.48") +
        "\\textwidth}\n\\resizebox{\\columnwidth}{!}{%\n"
        "\\begin{tabular}{" +
        std::string(columns + 1, 'l') + "}\\toprule\n" +
        row({"",
             "\\multicolumn{" + std::to_string(columns) + "}{c}{\\textit{" + table.head + "}}"}) +
        "\\cmidrule(lr){2-" + std::to_string(columns + 1) + "}\n" + row(head) + rules + "\n";
    for (size_t rank = 0; rank < ranks; rank++) {
        std::vector<std::string> cells = {rank == 0 ? "\\multirow{" + std::to_string(ranks) +
                                                          "}{*}{\\rotatebox{90}{\\textit{" +
                                                          (ranks < 4 ? "Ref." : "Reference") + "}}}"
                                                    : ""};
        for (const std::vector<std::string> &column : table.cells)
            cells.push_back(rank < column.size() ? column[rank] : "");
        text += row(cells);
    }
    return text + "\\bottomrule\n\\end{tabular}}\n\\caption{" + table.caption +
           "}\n\\end{subtable}\n";
}

std::string place_text(const eval::Evaluation &evaluation, const eval::Place &place,
                       const std::string &value)
{
    return coloured(place, value + " - " + latex_escaped(name_of(evaluation, place.reference)));
}

RankingTable true_table(const eval::Evaluation &evaluation, const Group &group)
{
    RankingTable table{"Query / \\texttt{Recall@1} with access to all references",
                       "Localisation rank by \\texttt{Recall@1} (\\%), $\\downarrow$.",
                       {},
                       {}};
    for (const size_t q : group.queries) {
        const eval::QueryResult &query = evaluation.queries[q];
        table.queries.push_back(name_of(evaluation, query.traversal) + " / " +
                                program::fixed(query.all.recall[0], 2));
        table.cells.emplace_back();
        for (const eval::Place &place : eval::true_places(evaluation, q))
            table.cells.back().push_back(
                place_text(evaluation, place, program::fixed(place.value, 2)));
    }
    return table;
}

RankingTable method_table(const eval::Evaluation &evaluation, const Group &group,
                          const eval::MethodResult &method)
{
    RankingTable table{"Query",
                       "Experience rank by " + latex_escaped(eval::title_of(method.name)) + " (" +
                           latex_escaped(eval::unit_of(method.name)) + "), $\\uparrow$.",
                       {},
                       {}};
    for (const size_t q : group.queries) {
        table.queries.push_back(name_of(evaluation, evaluation.queries[q].traversal));
        table.cells.emplace_back();
        for (const eval::Place &place : eval::predicted_places(evaluation, q, method))
            table.cells.back().push_back(place_text(evaluation, place, distance_text(place.value)));
    }
    return table;
}

std::string float_of(const std::string &caption, const std::string &tables)
{
    return "\n\\begin{table}\n\\centering\n" + tables + "\\caption{" + caption +
           "}\n\\end{table}\n";
}

std::string rankings(const eval::Evaluation &evaluation, const Group &group)
{
    std::string tables = latex_of(true_table(evaluation, group));
    for (const eval::MethodResult &method : evaluation.methods)
        if (!method.distance.empty())
            tables += latex_of(method_table(evaluation, group, method));
    return float_of("Experience ordering for each query on " + latex_escaped(evaluation.dataset) +
                        (group.name.empty() ? "" : ", " + latex_escaped(group.name)) + ", " +
                        latex_escaped(evaluation.backbone.identity.backbone) +
                        ". Orange: one rank off; red: two or more.",
                    tables);
}

// heads: LaTeX. Names to the left, numbers to the right.
std::string plain_table(const std::vector<std::string> &heads, const std::string &rows)
{
    const std::string table = "\\begin{tabular}{l" + std::string(heads.size() - 1, 'r') +
                              "}\\toprule\n" + row(heads) + "\\midrule\n" + rows +
                              "\\bottomrule\n\\end{tabular}";
    return heads.size() > columns_natural ? "\\resizebox{\\textwidth}{!}{%\n" + table + "}\n"
                                          : table + "\n";
}

std::string number(double value, int digits)
{
    return (value < 0 ? "$-$" : "") + program::fixed(std::abs(value), digits);
}

// The average and its interval. best: emphasised as in the paper.
std::string average_cell(const eval::Mean &mean, int digits, bool best)
{
    if (std::isnan(mean.value))
        return "--";
    const std::string value = number(mean.value, digits);
    const std::string interval = std::isnan(mean.low)
                                     ? ""
                                     : " {\\scriptsize [" + number(mean.low, digits) + ", " +
                                           number(mean.high, digits) + "]}";
    return (best ? "\\cellcolor{gray!25}\\textbf{" + value + "}" : value) + interval;
}

// Errors are best if least, agreement if most, correlations of distance and recall if least.
bool is_best(const eval::Evaluation &evaluation, const eval::RankingMetric &metric, double value)
{
    const double sign = metric.value == &vdna_ranking_metrics::kendall_tau ? -1 : 1;
    return std::none_of(evaluation.methods.begin(), evaluation.methods.end(),
                        [&](const eval::MethodResult &method) {
                            return sign * (method.judged.metrics.*metric.value) < sign * value;
                        });
}

std::string errors(const eval::Evaluation &evaluation)
{
    std::vector<std::string> heads = {"Method"};
    for (const eval::RankingMetric &metric : eval::ranking_metrics)
        heads.push_back(latex_escaped(metric.title));
    std::string rows;
    for (const eval::MethodResult &method : evaluation.methods) {
        std::vector<std::string> cells = {latex_escaped(eval::title_of(method.name))};
        for (const eval::RankingMetric &metric : eval::ranking_metrics) {
            const eval::Mean mean = method.judged.of(metric.value);
            cells.push_back(average_cell(mean, 2, is_best(evaluation, metric, mean.value)));
        }
        rows += row(cells);
    }
    return float_of("Ranking errors averaged over queries, with 95\\,\\% bootstrap intervals.",
                    plain_table(heads, rows));
}

std::string localisers(const eval::Evaluation &evaluation)
{
    std::string rows;
    for (const eval::LocaliserResult &result : evaluation.localisers)
        rows += row({latex_escaped(eval::localiser_of(result.name).title),
                     average_cell(result.mean.recall, 2, false),
                     average_cell(result.chosen.recall, 2, false)});
    return float_of(
        "\\texttt{Recall@1} (\\%) averaged over queries, with 95\\,\\% bootstrap intervals.",
        plain_table({"Localiser", "Mean over references", "In the first choice"}, rows));
}

} // namespace

std::string latex_escaped(const std::string &text)
{
    std::string latex;
    for (const char c : valid_utf8(text)) {
        if (std::string("&%$#_{}").find(c) != std::string::npos)
            latex += std::string("\\") + c;
        else if (c == '\\')
            latex += "\\textbackslash{}";
        else if (c == '~')
            latex += "\\textasciitilde{}";
        else if (c == '^')
            latex += "\\textasciicircum{}";
        else if (c == '<')
            latex += "\\textless{}";
        else if (c == '>')
            latex += "\\textgreater{}";
        else if (c == '"')
            latex += "{\\char34}"; // in every font encoding
        else if (c == '[' || c == ']' || c == '-' || c == '`' || c == '\'')
            latex += std::string("{") + c + "}"; // no ligature, and no argument of a row's end
        else
            latex += static_cast<unsigned char>(c) < ' ' || c == 0x7f ? ' ' : c;
    }
    return latex;
}

std::string latex_of(const eval::Evaluation &evaluation)
{
    std::string text = preamble;
    for (const Group &group : groups_of(evaluation))
        text += rankings(evaluation, group);
    return text + errors(evaluation) + localisers(evaluation);
}

} // namespace vdna::report
