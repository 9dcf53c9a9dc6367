// The contribution of each neuron to the distance of Visual DNA.
#include <algorithm>
#include <functional>

#include "eval/placing.hpp"
#include "program/print.hpp"
#include "report/chart.hpp"
#include "report/html.hpp"
#include "report/sections.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

constexpr size_t listed_neurons = 10;

// The nearest and the farthest reference of a query, by Visual DNA.
struct Extremes {
    const eval::PairResult *near, *far;
};

Extremes extremes_of(const eval::Evaluation &evaluation, size_t query)
{
    const std::vector<eval::Place> places =
        eval::predicted_places(evaluation, query, evaluation.methods.front());
    return {&eval::pair_with(evaluation.queries[query], places.front().reference),
            &eval::pair_with(evaluation.queries[query], places.back().reference)};
}

Curve curve_of(const eval::Evaluation &evaluation, const eval::PairResult &pair)
{
    Curve curve{name_of(evaluation, pair.reference), pair.neuron_emd_bins};
    std::sort(curve.heights.begin(), curve.heights.end(), std::greater<>());
    return curve;
}

Figure chart_of(const eval::Evaluation &evaluation, size_t query)
{
    const Extremes extremes = extremes_of(evaluation, query);
    const Figure chart =
        curve_chart("neurons, largest contribution first", "EMD, bins",
                    {curve_of(evaluation, *extremes.near), curve_of(evaluation, *extremes.far)});
    const Figure key = key_figure({"nearest: " + name_of(evaluation, extremes.near->reference),
                                   "farthest: " + name_of(evaluation, extremes.far->reference)});
    return arranged("neurons-" + name_of(evaluation, evaluation.queries[query].traversal),
                    chart.title, {chart, key}, chart.width);
}

// A number with a bar of proportional length.
std::string bar_cell(double value, double longest)
{
    return element("td class=\"number\"",
                   program::fixed(value, 1) +
                       "<svg class=\"bar\" viewBox=\"0 0 100 8\" aria-hidden=\"true\" "
                       "preserveAspectRatio=\"none\"><rect width=\"" +
                       program::fixed(longest > 0 ? 100 * value / longest : 0, 1) +
                       "\" height=\"8\"/></svg>");
}

// The neurons that best tell the nearest reference from the farthest.
std::string table_of(const eval::Evaluation &evaluation, const Extremes &extremes)
{
    const std::vector<double> &near = extremes.near->neuron_emd_bins;
    const std::vector<double> &far = extremes.far->neuron_emd_bins;
    std::vector<size_t> order(near.size());
    for (size_t i = 0; i < order.size(); i++)
        order[i] = i;
    const size_t listed = std::min(order.size(), listed_neurons);
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(listed),
                      order.end(), [&](size_t a, size_t b) {
                          const double d = (far[a] - near[a]) - (far[b] - near[b]);
                          return d != 0 ? d > 0 : a < b;
                      });
    order.resize(listed);
    double longest = 0;
    for (const size_t i : order)
        longest = std::max({longest, near[i], far[i]});
    std::string rows;
    for (const size_t i : order)
        rows += element("tr", text_element("th scope=\"row\"", std::to_string(i)) +
                                  bar_cell(near[i], longest) + bar_cell(far[i], longest));
    const auto head = [&](const eval::PairResult &pair) {
        return text_element("th scope=\"col\"", name_of(evaluation, pair.reference) + ", bins");
    };
    return table(
        "Neurons that tell them apart best",
        element("tr", "<th scope=\"col\">Neuron</th>" + head(*extremes.near) + head(*extremes.far)),
        rows);
}

} // namespace

std::vector<Figure> neuron_figures(const eval::Evaluation &evaluation)
{
    std::vector<Figure> figures;
    for (size_t q = 0; q < std::min(evaluation.queries.size(), shown_most); q++)
        figures.push_back(chart_of(evaluation, q));
    return figures;
}

std::string neurons_section(const eval::Evaluation &evaluation)
{
    std::string html = "<h2>Contributions of single neurons</h2>";
    const size_t shown = std::min(evaluation.queries.size(), shown_most);
    for (size_t q = 0; q < shown; q++)
        html += foldable(
            "Query " + text_element("b", name_of(evaluation, evaluation.queries[q].traversal)),
            q == 0,
            charts({chart_of(evaluation, q)}) + table_of(evaluation, extremes_of(evaluation, q)));
    return html;
}

} // namespace vdna::report
