// Correlation of distance and recall.
#include <cmath>

#include "eval/methods.hpp"
#include "program/print.hpp"
#include "report/chart.hpp"
#include "report/html.hpp"
#include "report/sections.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

constexpr double file_width = 600;

std::vector<Point> points_of(const eval::Evaluation &evaluation, const eval::MethodResult &method)
{
    std::vector<Point> points;
    const size_t columns = evaluation.references.size();
    for (size_t q = 0; q < evaluation.queries.size(); q++)
        for (size_t r = 0; r < columns; r++) {
            const double recall = evaluation.recall[q * columns + r];
            const double distance = method.distance[q * columns + r];
            if (!std::isnan(recall))
                points.push_back({distance, recall, q,
                                  name_of(evaluation, evaluation.queries[q].traversal) + " in " +
                                      name_of(evaluation, evaluation.references[r]) + ": " +
                                      distance_text(distance) + " " + eval::unit_of(method.name) +
                                      ", " + program::fixed(recall, 2) + " %"});
        }
    return points;
}

Figure figure_of(const eval::Evaluation &evaluation, const eval::MethodResult &method)
{
    const eval::JudgedRanking &judged = method.judged;
    Figure chart = scatter_chart("distance, " + eval::unit_of(method.name), "Recall@1, %", 100,
                                 points_of(evaluation, method), evaluation.queries.size());
    chart.name = "distance-recall-" + method.name;
    chart.caption = eval::title_of(method.name) + ": correlation within queries " +
                    mean_text(judged.of(&vdna_ranking_metrics::pearson_within), 3) +
                    ", over all pairs " +
                    mean_text(judged.of(&vdna_ranking_metrics::pearson_pooled), 3);
    return chart;
}

std::vector<Figure> charts_of(const eval::Evaluation &evaluation)
{
    std::vector<Figure> figures;
    for (const eval::MethodResult &method : evaluation.methods)
        if (!method.distance.empty())
            figures.push_back(figure_of(evaluation, method));
    return figures;
}

Figure key_of(const eval::Evaluation &evaluation)
{
    std::vector<std::string> names;
    for (const eval::QueryResult &query : evaluation.queries)
        names.push_back(name_of(evaluation, query.traversal));
    return key_figure(names);
}

} // namespace

std::vector<Figure> correlation_figures(const eval::Evaluation &evaluation)
{
    std::vector<Figure> figures;
    for (const Figure &chart : charts_of(evaluation))
        figures.push_back(
            arranged(chart.name, chart.title, {chart, key_of(evaluation)}, file_width));
    return figures;
}

std::string correlation_section(const eval::Evaluation &evaluation)
{
    const Figure key = key_of(evaluation);
    return "<h2>Distance against recall</h2><p>One dot per query and reference; point at a dot to "
           "see its name.</p>" +
           charts(charts_of(evaluation)) +
           element("div style=\"width:" + program::fixed(key.width, 0) + "px;max-width:100%\"",
                   "Query" + svg_element(key));
}

} // namespace vdna::report
