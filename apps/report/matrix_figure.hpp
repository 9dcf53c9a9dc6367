// Difference matrices as figures: shades, axes, and the matches over them.
#pragma once

#include <string>
#include <vector>

#include "report/figure.hpp"
#include "report/picture.hpp"

namespace vdna::report
{

// What is known of a match.
enum class Verdict { right, wrong, unknown };

struct MatrixMatch {
    size_t row;
    double column;
    Verdict verdict;
};

// Columns of a map joined from several references.
struct MatrixPart {
    std::string name;
    size_t columns;
};

// The difference matrix of one map.
struct MatrixPanel {
    std::string title; // "1  winter"
    std::string note;  // "Recall@1 93.1 %"
    bool is_chosen = false, is_best = false;
    Shades difference{};                  // [live frames][map frames]
    double first_live = 0, last_live = 0; // frame numbers of the first and last row
    std::vector<MatrixMatch> matches{};
    std::vector<MatrixMatch>
        nearest{};                    // those of each frame by itself, if `matches` are a filter's
    std::vector<MatrixMatch> truth{}; // map frames of the same place; their verdict is ignored
    std::vector<MatrixPart> parts{};  // of a joined map; none = one reference, with axis numbers
};

// The same shades for all panels, so that they can be compared. panels: at least one, with values.
void share_scale(std::vector<MatrixPanel> &panels);

// Live frames downwards, map frames to the right; near is black, far is white.
// width, height: of the matrix itself, without its axes.
Figure panel_figure(const MatrixPanel &panel, double width, double height);

// The scale of the shades, and what the marks of these panels mean.
Figure legend_figure(const std::vector<MatrixPanel> &panels);

} // namespace vdna::report
