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

Leaders leaders_of(const eval::Evaluation &evaluation, size_t query)
{
    const std::vector<eval::Place> places =
        eval::predicted_places(evaluation, query, evaluation.methods.front());
    return {&eval::pair_with(evaluation.queries[query], places[0].reference),
            &eval::pair_with(evaluation.queries[query], places[1].reference)};
}

Curve curve_of(const eval::Evaluation &evaluation, const eval::PairResult &pair)
{
    Curve curve{name_of(evaluation, pair.reference), pair.neuron_emd_bins};
    std::sort(curve.heights.begin(), curve.heights.end(), std::greater<>());
    return curve;
}

Figure chart_of(const eval::Evaluation &evaluation, size_t query)
{
    const Leaders leaders = leaders_of(evaluation, query);
    const Figure chart = curve_chart(
        "neurons, largest EMD first", "EMD, bins",
        {curve_of(evaluation, *leaders.winner), curve_of(evaluation, *leaders.against)});
    const Figure key = key_figure({"first: " + name_of(evaluation, leaders.winner->reference),
                                   "second: " + name_of(evaluation, leaders.against->reference)});
    return arranged("neurons-" + name_of(evaluation, evaluation.queries[query].traversal),
                    chart.title, {chart, key}, chart.width);
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
    return text_element("p", sentence_of(explanation)) + charts({chart_of(evaluation, query)}) +
           reasons_table(explanation) +
           (explainer.taps().size() > 1 ? taps_table(explanation) : "");
}

} // namespace

std::vector<Figure> neuron_figures(const eval::Evaluation &evaluation)
{
    std::vector<Figure> figures;
    for (size_t q = 0; q < std::min(evaluation.queries.size(), shown_most); q++)
        if (evaluation.queries[q].pairs.size() > 1)
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
            q == 0, explanation_of(evaluation, q));
    return html;
}

} // namespace vdna::report
