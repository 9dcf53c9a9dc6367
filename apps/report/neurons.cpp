// Which neurons make the first choice of Visual DNA another than the second.
#include <algorithm>
#include <functional>

#include <vdna/cpp/error.hpp>

#include "eval/placing.hpp"
#include "report/chart.hpp"
#include "report/explanation.hpp"
#include "report/html.hpp"
#include "report/sections.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

constexpr uint32_t listed_neurons = 10;

// The first two of a query, by Visual DNA.
struct Leaders {
    const eval::PairResult *winner, *against;
};

const eval::PairResult *pair_with(const eval::QueryResult &query, size_t reference)
{
    return &*std::find_if(
        query.pairs.begin(), query.pairs.end(),
        [&](const eval::PairResult &pair) { return pair.reference == reference; });
}

Leaders leaders_of(const eval::Evaluation &evaluation, size_t query)
{
    const std::vector<eval::Place> places =
        eval::predicted_places(evaluation, query, evaluation.methods.front());
    return {pair_with(evaluation.queries[query], places[0].reference),
            pair_with(evaluation.queries[query], places[1].reference)};
}

Curve curve_of(const eval::Evaluation &evaluation, const eval::PairResult &pair)
{
    Curve curve{name_of(evaluation, pair.reference), pair.neuron_emd_bins};
    std::sort(curve.heights.begin(), curve.heights.end(), std::greater<>());
    return curve;
}

std::string chart_of(const eval::Evaluation &evaluation, const Leaders &leaders)
{
    const auto key = [&](const eval::PairResult &pair, size_t series) {
        return element("span class=\"key\"",
                       "<svg viewBox=\"0 0 10 10\" aria-hidden=\"true\"><rect y=\"3\" "
                       "width=\"10\" height=\"4\" fill=\"" +
                           series_colour(series, 2) + "\"/></svg>" +
                           escaped(name_of(evaluation, pair.reference)));
    };
    return element("figure", curve_chart("neurons, largest EMD first", "EMD, bins",
                                         {curve_of(evaluation, *leaders.winner),
                                          curve_of(evaluation, *leaders.against)}) +
                                 element("figcaption", "first " + key(*leaders.winner, 0) +
                                                           " second " + key(*leaders.against, 1)));
}

std::string explanation_of(const eval::Evaluation &evaluation, size_t query)
{
    if (evaluation.queries[query].pairs.size() < 2)
        return element("p", "There is one reference only.");
    const Leaders leaders = leaders_of(evaluation, query);
    Explainer explainer(evaluation.backbone.identity, listed_neurons);
    require(explainer.explain(leaders.winner->neuron_emd_bins, leaders.against->neuron_emd_bins),
            "contributions of neurons");
    const Explanation explanation{name_of(evaluation, leaders.winner->reference),
                                  name_of(evaluation, leaders.against->reference), explainer};
    return text_element("p", sentence_of(explanation)) +
           element("div class=\"charts\"",
                   chart_of(evaluation, leaders) + element("div", reasons_table(explanation))) +
           (explainer.taps().size() > 1 ? taps_table(explanation) : "");
}

} // namespace

std::string neurons_section(const eval::Evaluation &evaluation)
{
    std::string html =
        "<h2>Contributions of single neurons</h2><p>The distance of Visual DNA is the mean of one "
        "Earth Mover's Distance (EMD) per neuron: the mean number of histogram bins, of " +
        std::to_string(evaluation.bins) +
        ", by which its activations in the warmup must move to match those of the "
        "reference. This section shows what tells the first choice of each query from the second: "
        "the margin, the distance of the second less that of the first, is the sum of what the "
        "neurons add, "
        "above 0 for the first and below 0 for the second.</p>";
    const size_t shown = std::min(evaluation.queries.size(), shown_most);
    for (size_t q = 0; q < shown; q++) {
        html += foldable(
            "Query " + text_element("b", name_of(evaluation, evaluation.queries[q].traversal)),
            q == 0, explanation_of(evaluation, q));
    }
    return html;
}

} // namespace vdna::report
