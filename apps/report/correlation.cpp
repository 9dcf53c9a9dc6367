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

std::string figure(const eval::Evaluation &evaluation, const eval::MethodResult &method)
{
    const vdna_ranking_metrics &m = method.metrics;
    return element("figure",
                   scatter_chart("distance, " + eval::unit_of(method.name), "Recall@1, %", 100,
                                 points_of(evaluation, method), evaluation.queries.size()) +
                       element("figcaption",
                               text_element("b", eval::title_of(method.name)) +
                                   escaped(": correlation " + number_text(m.pearson_within, 3) +
                                           " within queries, " + number_text(m.pearson_pooled, 3) +
                                           " over all (Pearson)")));
}

std::string legend(const eval::Evaluation &evaluation)
{
    std::string html;
    for (size_t q = 0; q < evaluation.queries.size(); q++)
        html += element(
            "span class=\"key\"",
            "<svg viewBox=\"0 0 10 10\" aria-hidden=\"true\"><circle cx=\"5\" cy=\"5\" r=\"5\" "
            "fill=\"" +
                series_colour(q, evaluation.queries.size()) + "\"/></svg>" +
                escaped(name_of(evaluation, evaluation.queries[q].traversal)));
    return element("p class=\"legend\"", "Query: " + html);
}

} // namespace

std::string correlation_section(const eval::Evaluation &evaluation)
{
    std::string charts;
    for (const eval::MethodResult &method : evaluation.methods)
        if (!method.distance.empty())
            charts += figure(evaluation, method);
    return "<h2>Distance against recall</h2><p>One dot per query and reference; point at a dot to "
           "see its name. For a good method, the dots lie on a falling line: the smaller the "
           "distance, the more frames are localised.</p>" +
           legend(evaluation) + element("div class=\"charts\"", charts);
}

} // namespace vdna::report
