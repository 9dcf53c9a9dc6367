#include "report/difference_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "program/print.hpp"
#include "program/replaced_file.hpp"
#include "report/matrix_figure.hpp"
#include "report/wording.hpp"

namespace vdna::report
{

namespace
{

// All matrices are in memory at once, because they share one scale.
constexpr uint64_t cells_max = uint64_t{1} << 27;
constexpr double side = 300;        // of a matrix
constexpr double width_most = 1500; // of the figure
constexpr double png_scale = 2;     // pixels per unit

std::string ending_of(const std::string &file)
{
    const size_t dot = file.rfind('.');
    return dot == std::string::npos ? "" : file.substr(dot);
}

std::string note_of(const record::Followed &followed, bool with_filter)
{
    if (followed.nearest.judged() == 0)
        return "not labelled alike";
    const std::string nearest = program::fixed(followed.nearest.recall_percent(), 1) + " %";
    return with_filter ? "filter " + program::fixed(followed.filter.recall_percent(), 1) +
                             " %, nearest " + nearest
                       : "Recall@1 " + nearest;
}

std::vector<MatrixMatch> matches_of(const record::Localisation &localisation)
{
    std::vector<MatrixMatch> matches;
    for (size_t row = 0; row < localisation.matches.size(); row++) {
        const record::Match &match = localisation.matches[row];
        matches.push_back({row, static_cast<double>(match.frame),
                           !match.judged ? Verdict::unknown
                           : match.good  ? Verdict::right
                                         : Verdict::wrong});
    }
    return matches;
}

double mean_distance(const record::Localisation &localisation)
{
    double sum = 0;
    for (const record::Match &match : localisation.matches)
        sum += match.distance;
    return sum / static_cast<double>(localisation.matches.size());
}

// The most recall first, or if that is not known of all the least distance.
std::vector<size_t> ranked(const std::vector<record::Followed> &followed, bool with_filter)
{
    const bool is_judged =
        std::all_of(followed.begin(), followed.end(),
                    [](const record::Followed &f) { return f.nearest.judged() > 0; });
    const auto cost = [&](size_t i) {
        const record::Localisation &told = with_filter ? followed[i].filter : followed[i].nearest;
        return is_judged ? -told.recall_percent() : mean_distance(followed[i].nearest);
    };
    std::vector<size_t> order(followed.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t a, size_t b) { return cost(a) < cost(b); });
    return order;
}

MatrixPanel panel_of(const record::Recording &live, const record::Followed &followed,
                     bool with_filter, size_t rank)
{
    MatrixPanel panel{std::to_string(rank + 1) + "  " + followed.nearest.experience,
                      note_of(followed, with_filter)};
    const size_t rows = followed.nearest.matches.size();
    panel.difference = {rows, followed.distances.size() / rows, followed.distances, 0, 1};
    panel.first_live = static_cast<double>(live.index.front());
    panel.last_live = static_cast<double>(live.index.back());
    panel.matches = matches_of(with_filter ? followed.filter : followed.nearest);
    if (with_filter)
        panel.nearest = matches_of(followed.nearest);
    return panel;
}

Figure figure_of(const std::vector<MatrixPanel> &panels)
{
    std::vector<Figure> parts;
    for (const MatrixPanel &panel : panels) {
        const double shape = static_cast<double>(panel.difference.rows) /
                             static_cast<double>(panel.difference.columns);
        parts.push_back(panel_figure(panel, side, std::clamp(side * shape, side / 2, 2 * side)));
    }
    parts.push_back(legend_figure(panels));
    return arranged("difference", "Difference matrices", parts, width_most);
}

} // namespace

void require_drawable(const record::Recording &live,
                      const std::vector<const vdna_experience *> &experiences,
                      const std::string &file)
{
    const std::string ending = ending_of(file);
    if (ending != ".png" && ending != ".svg" && ending != ".pdf")
        throw Error(file + ": ends in '" + ending + "', expected .png, .svg or .pdf");
    uint64_t cells = 0;
    for (const vdna_experience *experience : experiences)
        cells += uint64_t{live.frames} * experience->frames;
    if (cells > cells_max)
        throw Error(file + ": " + std::to_string(cells) + " frame pairs, expected at most " +
                    std::to_string(cells_max) + "; set --every or --in");
}

void draw_difference_matrices(const record::Recording &live,
                              const std::vector<record::Followed> &followed, bool with_filter,
                              const std::string &file)
{
    std::vector<MatrixPanel> panels;
    for (const size_t i : ranked(followed, with_filter))
        panels.push_back(panel_of(live, followed[i], with_filter, panels.size()));
    share_scale(panels);
    const Figure figure = figure_of(panels);
    const std::string ending = ending_of(file);
    program::replace_file(file,
                          ending == ".svg"   ? svg_file(figure)
                          : ending == ".pdf" ? pdf_file(figure)
                                             : png_file(figure, png_scale),
                          program::Durability::quick);
}

} // namespace vdna::report
