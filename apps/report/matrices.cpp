// Difference matrices, as in the paper's figure that motivates the choice of an experience.
#include <algorithm>
#include <cmath>

#include "eval/localise_query.hpp"
#include "program/interrupt.hpp"
#include "program/print.hpp"
#include "report/html.hpp"
#include "report/picture.hpp"
#include "report/sections.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

constexpr int side = 220;       // pixels
constexpr int small_side = 110; // if there are many matrices
constexpr size_t many = 24;     // pairs
constexpr double far_tolerances = 3;

// For a long traversal, sample evenly as many live frames as a picture has rows.
eval::QueryResult sampled(const eval::QueryResult &query)
{
    eval::QueryResult sample{
        query.traversal, query.warmup_begin, query.warmup_frames, {}, {}, {}, {}, query.projection};
    const size_t rows = std::min<size_t>(query.live.size(), side);
    for (size_t i = 0; i < rows; i++)
        sample.live.push_back(query.live[i * query.live.size() / rows]);
    return sample;
}

// Use the same shades for all references of a query, so that they can be compared.
void stretch(std::vector<Shades> &matrices)
{
    float low = matrices[0].values[0], high = low;
    for (const Shades &matrix : matrices) {
        const auto ends = std::minmax_element(matrix.values.begin(), matrix.values.end());
        low = std::min(low, *ends.first);
        high = std::max(high, *ends.second);
    }
    for (Shades &matrix : matrices) {
        matrix.black = static_cast<double>(low);
        matrix.white = high > low ? static_cast<double>(high) : matrix.black + 1;
    }
}

std::string figure(const eval::Evaluation &evaluation, const eval::QueryResult &sample,
                   const eval::PairResult &pair, const Shades &difference, int pixels)
{
    const std::string &name = name_of(evaluation, pair.reference);
    const double far = far_tolerances * std::max(evaluation.tolerance, 1.0);
    Shades truth = {difference.rows, difference.columns,
                    eval::ground_truth_matrix(evaluation, sample, pair.reference), 0, far};
    // Frames without ground truth are white, like places that are not the same.
    std::replace_if(
        truth.values.begin(), truth.values.end(), [](float apart) { return std::isnan(apart); },
        static_cast<float>(far));
    return element(
        "figure",
        shades_picture(difference, pixels, "difference matrix of " + name) +
            shades_picture(truth, pixels, "ground truth of " + name) +
            element("figcaption", text_element("b", name) + "<br>Recall@1 " +
                                      escaped(program::fixed(pair.outcome.recall[0], 2)) + " %"));
}

std::string matrices_of(const eval::Evaluation &evaluation, const eval::QueryResult &query,
                        int pixels)
{
    const eval::QueryResult sample = sampled(query);
    const size_t shown = std::min(query.pairs.size(), shown_most);
    std::vector<Shades> differences;
    for (size_t i = 0; i < shown; i++) {
        program::require_not_interrupted();
        const size_t reference = query.pairs[i].reference;
        differences.push_back({sample.live.size(),
                               (*evaluation.traversals)[reference].recording.frames,
                               eval::difference_matrix(evaluation, sample, reference), 0, 1});
    }
    stretch(differences);
    std::string html;
    for (size_t i = 0; i < shown; i++)
        html += figure(evaluation, sample, query.pairs[i], differences[i], pixels);
    return element("div class=\"matrices\"", html);
}

} // namespace

std::string matrices_section(const eval::Evaluation &evaluation)
{
    std::string html =
        "<h2>Difference matrices</h2><p>Upper picture: the distance of the embeddings of each "
        "live frame (from top to bottom) and each map frame (from left to right); near is black, "
        "far is white, with the same shades for all references of a query. Lower picture: the "
        "ground truth, black if both frames were taken at the same place, white from " +
        program::fixed(far_tolerances, 0) +
        " tolerances on. If the dark line of the lower picture also shows in the upper one, the "
        "places can be recognised.</p>";
    const size_t shown = std::min(evaluation.queries.size(), shown_most);
    const size_t pairs = shown * std::min(evaluation.references.size(), shown_most);
    for (size_t q = 0; q < shown; q++) {
        const eval::QueryResult &query = evaluation.queries[q];
        html += foldable("Query " + text_element("b", name_of(evaluation, query.traversal)) +
                             ", Recall@1 with all references at once " +
                             escaped(program::fixed(query.all.recall[0], 2)) + " %",
                         q == 0, matrices_of(evaluation, query, pairs > many ? small_side : side));
    }
    return html;
}

} // namespace vdna::report
