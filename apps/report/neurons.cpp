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

const eval::PairResult *pair_with(const eval::QueryResult &query, size_t reference)
{
    return &*std::find_if(
        query.pairs.begin(), query.pairs.end(),
        [&](const eval::PairResult &pair) { return pair.reference == reference; });
}

Extremes extremes_of(const eval::Evaluation &evaluation, size_t query)
{
    const std::vector<eval::Place> places =
        eval::predicted_places(evaluation, query, evaluation.methods.front());
    return {pair_with(evaluation.queries[query], places.front().reference),
            pair_with(evaluation.queries[query], places.back().reference)};
}

Curve curve_of(const eval::Evaluation &evaluation, const eval::PairResult &pair)
{
    Curve curve{name_of(evaluation, pair.reference), pair.neuron_emd_bins};
    std::sort(curve.heights.begin(), curve.heights.end(), std::greater<>());
    return curve;
}

std::string chart_of(const eval::Evaluation &evaluation, const Extremes &extremes)
{
    const auto key = [&](const eval::PairResult &pair, size_t series) {
        return element("span class=\"key\"",
                       "<svg viewBox=\"0 0 10 10\" aria-hidden=\"true\"><rect y=\"3\" "
                       "width=\"10\" height=\"4\" fill=\"" +
                           series_colour(series, 2) + "\"/></svg>" +
                           escaped(name_of(evaluation, pair.reference)));
    };
    return element("figure", curve_chart("neurons, largest contribution first", "EMD, bins",
                                         {curve_of(evaluation, *extremes.near),
                                          curve_of(evaluation, *extremes.far)}) +
                                 element("figcaption", "nearest " + key(*extremes.near, 0) +
                                                           " farthest " + key(*extremes.far, 1)));
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

std::string neurons_section(const eval::Evaluation &evaluation)
{
    std::string html =
        "<h2>Contributions of single neurons</h2><p>The distance of Visual DNA is the mean of one "
        "Earth Mover's Distance (EMD) per neuron: the mean number of histogram bins, of " +
        std::to_string(evaluation.bins) +
        ", by which its activations in the warmup must move to match those of the "
        "reference. This section shows the nearest and the farthest reference of each query.</p>";
    const size_t shown = std::min(evaluation.queries.size(), shown_most);
    for (size_t q = 0; q < shown; q++) {
        const Extremes extremes = extremes_of(evaluation, q);
        html += foldable(
            "Query " + text_element("b", name_of(evaluation, evaluation.queries[q].traversal)),
            q == 0,
            element("div class=\"charts\"", chart_of(evaluation, extremes) +
                                                element("div", table_of(evaluation, extremes))));
    }
    return html;
}

} // namespace vdna::report
