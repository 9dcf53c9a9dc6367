// Difference matrices, as in the paper's figure that motivates the choice of an experience.
#include <algorithm>
#include <cmath>

#include "eval/localise_query.hpp"
#include "eval/placing.hpp"
#include "program/interrupt.hpp"
#include "program/print.hpp"
#include "report/html.hpp"
#include "report/matrix_figure.hpp"
#include "report/sections.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

constexpr size_t rows_most = 220; // live frames of a matrix
constexpr double side = 190;      // of a matrix; the map of all references is twice as wide
constexpr double file_width = 1100;

// Where the sampled rows are in query.live: evenly over a long drive.
std::vector<size_t> sampled_rows(const eval::QueryResult &query)
{
    std::vector<size_t> at;
    const size_t rows = std::min(query.live.size(), rows_most);
    for (size_t i = 0; i < rows; i++)
        at.push_back(i * query.live.size() / rows);
    return at;
}

eval::QueryResult sampled(const eval::QueryResult &query, const std::vector<size_t> &rows)
{
    eval::QueryResult sample{
        query.traversal, query.warmup_begin, query.warmup_frames, {}, {}, {}, {}, query.projection};
    for (const size_t at : rows)
        sample.live.push_back(query.live[at]);
    return sample;
}

// offset: the column of the match's traversal.
MatrixMatch drawn(const eval::FrameMatch &match, size_t row, size_t offset)
{
    return {row, static_cast<double>(offset + match.frame),
            !match.judged ? Verdict::unknown
            : match.good  ? Verdict::right
                          : Verdict::wrong};
}

// The nearest map frame in truth of each live frame, if it is within tolerance.
std::vector<MatrixMatch> truth_of(const eval::Evaluation &evaluation,
                                  const eval::QueryResult &sample, size_t reference)
{
    const std::vector<float> apart = eval::ground_truth_matrix(evaluation, sample, reference);
    const size_t columns = apart.size() / sample.live.size();
    std::vector<MatrixMatch> truth;
    for (size_t row = 0; row < sample.live.size(); row++) {
        double least = HUGE_VAL;
        size_t nearest = 0;
        for (size_t c = 0; c < columns; c++)
            if (apart[row * columns + c] < least) { // false without ground truth
                least = apart[row * columns + c];
                nearest = c;
            }
        if (least <= evaluation.tolerance)
            truth.push_back({row, static_cast<double>(nearest), Verdict::unknown});
    }
    return truth;
}

std::string recall_text(const eval::Outcome &outcome)
{
    return "Recall@1 " + number_text(outcome.recall[0], 2) + " %";
}

// Makes the panels of one query.
class Panels
{
  public:
    Panels(const eval::Evaluation &evaluation, size_t query)
        : evaluation_(evaluation), query_(evaluation.queries[query]), rows_(sampled_rows(query_)),
          sample_(sampled(query_, rows_)),
          ranking_(eval::predicted_places(evaluation, query, evaluation.methods.front())),
          best_(eval::true_places(evaluation, query).front().value)
    {
    }

    std::vector<MatrixPanel> made()
    {
        std::vector<MatrixPanel> panels;
        const size_t shown = std::min(ranking_.size(), shown_most);
        for (size_t rank = 0; rank < shown; rank++) {
            program::require_not_interrupted();
            panels.push_back(of_reference(rank));
        }
        panels.push_back(of_all(panels));
        share_scale(panels);
        return panels;
    }

  private:
    MatrixPanel empty_panel(const std::string &title, const eval::Outcome &outcome) const
    {
        MatrixPanel panel{title, recall_text(outcome)};
        panel.difference.rows = sample_.live.size();
        panel.first_live = sample_.live.front();
        panel.last_live = sample_.live.back();
        return panel;
    }

    MatrixPanel of_reference(size_t rank) const
    {
        const size_t reference = ranking_[rank].reference;
        const eval::PairResult &pair = eval::pair_with(query_, reference);
        MatrixPanel panel = empty_panel(
            std::to_string(rank + 1) + "  " + name_of(evaluation_, reference), pair.outcome);
        panel.is_chosen = rank == 0;
        panel.is_best = ranking_.size() > 1 && pair.outcome.recall[0] >= best_;
        panel.difference.columns = (*evaluation_.traversals)[reference].recording.frames;
        panel.difference.values = eval::difference_matrix(evaluation_, sample_, reference);
        panel.truth = truth_of(evaluation_, sample_, reference);
        for (size_t row = 0; row < rows_.size(); row++)
            panel.matches.push_back(drawn(pair.outcome.matches[rows_[row]], row, 0));
        return panel;
    }

    // singles: the panels of the references, in the order of the ranking.
    MatrixPanel of_all(const std::vector<MatrixPanel> &singles) const
    {
        MatrixPanel panel = empty_panel("all references at once", query_.all);
        for (size_t rank = 0; rank < singles.size(); rank++) {
            const size_t reference = ranking_[rank].reference, offset = panel.difference.columns;
            panel.parts.push_back(
                {name_of(evaluation_, reference), singles[rank].difference.columns});
            panel.difference.columns += singles[rank].difference.columns;
            for (size_t row = 0; row < rows_.size(); row++)
                if (query_.all.matches[rows_[row]].traversal == reference)
                    panel.matches.push_back(drawn(query_.all.matches[rows_[row]], row, offset));
        }
        for (size_t row = 0; row < rows_.size(); row++)
            for (const MatrixPanel &single : singles) {
                const auto begin = single.difference.values.begin() +
                                   static_cast<std::ptrdiff_t>(row * single.difference.columns);
                panel.difference.values.insert(
                    panel.difference.values.end(), begin,
                    begin + static_cast<std::ptrdiff_t>(single.difference.columns));
            }
        return panel;
    }

    const eval::Evaluation &evaluation_;
    const eval::QueryResult &query_;
    std::vector<size_t> rows_;
    eval::QueryResult sample_; // with the sampled live frames only
    std::vector<eval::Place> ranking_;
    double best_; // recall, percent
};

// Panels, then the legend. One scale for live frames and map frames, within limits.
std::vector<Figure> parts_of(const eval::Evaluation &evaluation, size_t query)
{
    const std::vector<MatrixPanel> panels = Panels(evaluation, query).made();
    size_t longest = 1;
    for (const MatrixPanel &panel : panels)
        if (panel.parts.empty())
            longest = std::max(longest, panel.difference.columns);
    const double live = panels.front().last_live - panels.front().first_live + 1;
    const double height =
        std::clamp(side * live / static_cast<double>(longest), side / 2, 1.5 * side);
    std::vector<Figure> parts;
    for (const MatrixPanel &panel : panels)
        parts.push_back(panel_figure(panel, panel.parts.empty() ? side : 2 * side, height));
    parts.push_back(legend_figure(panels));
    return parts;
}

} // namespace

std::vector<Figure> matrix_figures(const eval::Evaluation &evaluation)
{
    std::vector<Figure> figures;
    for (size_t q = 0; q < std::min(evaluation.queries.size(), shown_most); q++) {
        const std::string &name = name_of(evaluation, evaluation.queries[q].traversal);
        figures.push_back(arranged("difference-" + name, "Difference matrices of the query " + name,
                                   parts_of(evaluation, q), file_width));
    }
    return figures;
}

std::string matrices_section(const eval::Evaluation &evaluation)
{
    std::string html =
        "<h2>Difference matrices</h2><p>Nearest reference by Visual DNA first; last, all "
        "references at once.</p>";
    const size_t shown = std::min(evaluation.queries.size(), shown_most);
    for (size_t q = 0; q < shown; q++) {
        std::string panels;
        for (const Figure &part : parts_of(evaluation, q))
            panels += element("div class=\"panel\" style=\"width:" + program::fixed(part.width, 0) +
                                  "px\"",
                              svg_element(part));
        const eval::QueryResult &query = evaluation.queries[q];
        html += foldable("Query " + text_element("b", name_of(evaluation, query.traversal)) +
                             ", Recall@1 with all references at once " +
                             escaped(number_text(query.all.recall[0], 2)) + " %",
                         q == 0, element("div class=\"matrices\"", panels));
    }
    return html;
}

} // namespace vdna::report
