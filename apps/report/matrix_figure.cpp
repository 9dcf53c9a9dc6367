#include "report/matrix_figure.hpp"

#include <algorithm>

#include "program/print.hpp"
#include "report/chart.hpp"

namespace vdna::report
{

namespace
{

constexpr double left = 46, top = 36, right = 12, bottom = 34; // around a matrix
constexpr int pixels_most = 400;                               // of a matrix, each way
constexpr size_t title_most = 26;                              // characters
constexpr double letter = 5.2;                                 // usual width of one on an axis
constexpr Colour white = {255, 255, 255}, truth_colour = {86, 180, 233};

Marks marks_of(Verdict verdict, double radius)
{
    switch (verdict) {
    case Verdict::right:
        return {Shape::dot, radius, right_colour, {}, true};
    case Verdict::wrong:
        return {Shape::cross, radius, wrong_colour, {}, true};
    default:
        return {Shape::dot, radius, unknown_colour, {}, true};
    }
}

// The place of a matrix in its figure.
struct Frame {
    const MatrixPanel &panel;
    double width, height;

    Spot spot(const MatrixMatch &match) const
    {
        return {left + (match.column + 0.5) / static_cast<double>(panel.difference.columns) * width,
                top + (static_cast<double>(match.row) + 0.5) /
                          static_cast<double>(panel.difference.rows) * height};
    }
};

void add_marks(const Frame &frame, const std::vector<MatrixMatch> &matches, double radius,
               Figure &figure)
{
    for (const Verdict verdict : {Verdict::unknown, Verdict::right, Verdict::wrong}) {
        Marks marks = marks_of(verdict, radius);
        for (const MatrixMatch &match : matches)
            if (match.verdict == verdict)
                marks.spots.push_back(frame.spot(match));
        figure.items.push_back(marks);
    }
}

// A word on a coloured ground that ends at x; returns where the one before it may end.
double add_tag(const std::string &word, const Colour &colour, double x, Figure &figure)
{
    constexpr double y = 18, height = 14;
    const Text text{0, y + 11, word, Anchor::middle, white, true, false, 10};
    const double width = text_room(text) + 8;
    figure.items.push_back(Box{x - width, y, width, height, colour});
    figure.items.push_back(text);
    std::get<Text>(figure.items.back()).x = x - width / 2;
    return x - width - 3;
}

void add_title(const Frame &frame, Figure &figure)
{
    const MatrixPanel &panel = frame.panel;
    figure.items.push_back(
        Text{left, 13, shortened(panel.title, title_most), Anchor::start, ink, true});
    figure.items.push_back(Text{left, 29, panel.note});
    double x = left + frame.width;
    if (panel.is_best)
        x = add_tag("best", best_colour, x, figure);
    if (panel.is_chosen)
        add_tag("chosen", chosen_colour, x, figure);
}

void add_y_axis(const Frame &frame, Figure &figure)
{
    const MatrixPanel &panel = frame.panel;
    const double span = std::max(panel.last_live - panel.first_live, 1.0);
    for (const Tick &tick : ticks_of(panel.first_live, panel.first_live + span, 4)) {
        const double y = top + (tick.value - panel.first_live) / span * frame.height;
        figure.items.push_back(Line{{{left - 4, y}, {left, y}}, faint});
        figure.items.push_back(Text{left - 6, y + 4, tick.text, Anchor::end});
    }
    figure.items.push_back(
        Text{11, top + frame.height / 2, "live frame", Anchor::middle, faint, false, true});
}

void add_x_axis(const Frame &frame, Figure &figure)
{
    const auto last = static_cast<double>(std::max<size_t>(frame.panel.difference.columns, 2) - 1);
    const double y = top + frame.height;
    for (const Tick &tick : ticks_of(0, last, frame.width / 50)) {
        const double x = left + tick.value / last * frame.width;
        figure.items.push_back(Line{{{x, y}, {x, y + 4}}, faint});
        figure.items.push_back(Text{x, y + 15, tick.text, Anchor::middle});
    }
    figure.items.push_back(Text{left + frame.width / 2, y + 29, "map frame", Anchor::middle});
}

// The borders and names of the parts of a joined map.
void add_parts(const Frame &frame, Figure &figure)
{
    const double y = top + frame.height;
    double x = left;
    for (const MatrixPart &part : frame.panel.parts) {
        const double width = static_cast<double>(part.columns) /
                             static_cast<double>(frame.panel.difference.columns) * frame.width;
        if (x > left)
            figure.items.push_back(Line{{{x, top}, {x, y + 4}}, truth_colour, 1});
        const auto most = static_cast<size_t>(std::max(width / letter, 2.0));
        figure.items.push_back(
            Text{x + width / 2, y + 15, shortened(part.name, most), Anchor::middle});
        x += width;
    }
    figure.items.push_back(Text{left + frame.width / 2, y + 29,
                                "map frame, one reference after another", Anchor::middle});
}

bool has(const std::vector<MatrixPanel> &panels, std::vector<MatrixMatch> MatrixPanel::*list)
{
    return std::any_of(panels.begin(), panels.end(),
                       [&](const MatrixPanel &panel) { return !(panel.*list).empty(); });
}

bool has(const std::vector<MatrixPanel> &panels, Verdict verdict)
{
    return std::any_of(panels.begin(), panels.end(), [&](const MatrixPanel &panel) {
        return std::any_of(panel.matches.begin(), panel.matches.end(),
                           [&](const MatrixMatch &match) { return match.verdict == verdict; });
    });
}

// Rows of a legend, one below another.
class Legend
{
  public:
    explicit Legend(Figure &figure) : figure_(figure) {}

    void add(Marks marks, const std::string &meaning)
    {
        figure_.height += 17;
        marks.spots = {{8, figure_.height - 8}};
        figure_.items.push_back(marks);
        const Text text{20, figure_.height - 4, meaning};
        figure_.items.push_back(text);
        figure_.width = std::max(figure_.width, 24 + text_room(text));
    }

  private:
    Figure &figure_;
};

// From near to far, with their distances.
void add_scale(const Shades &shades, Figure &figure)
{
    constexpr double x = 4, y = 18, width = 150, height = 12;
    Shades ramp{1, 64, {}, 0, 63};
    for (size_t i = 0; i < ramp.columns; i++)
        ramp.values.push_back(static_cast<float>(i));
    const Encoded png = shades_png(ramp, 64);
    figure.items.push_back(Text{x, 12, "distance of the embeddings"});
    figure.items.push_back(Raster{x, y, width, height, png.bytes, false, png.columns, png.rows});
    figure.items.push_back(Box{x, y, width, height, faint, false});
    figure.items.push_back(Text{x, 42, "near " + program::fixed(shades.black, 2)});
    figure.items.push_back(
        Text{x + width, 42, "far " + program::fixed(shades.white, 2), Anchor::end});
    figure.width = x + width + 4;
    figure.height = 48;
}

} // namespace

void share_scale(std::vector<MatrixPanel> &panels)
{
    float low = panels[0].difference.values[0], high = low;
    for (const MatrixPanel &panel : panels) {
        const auto &values = panel.difference.values;
        const auto ends = std::minmax_element(values.begin(), values.end());
        low = std::min(low, *ends.first);
        high = std::max(high, *ends.second);
    }
    for (MatrixPanel &panel : panels) {
        panel.difference.black = static_cast<double>(low);
        panel.difference.white =
            high > low ? static_cast<double>(high) : panel.difference.black + 1;
    }
}

Figure panel_figure(const MatrixPanel &panel, double width, double height)
{
    const Frame frame{panel, width, height};
    Figure figure{"", "Difference matrix: " + panel.title + ", " + panel.note, left + width + right,
                  top + height + bottom};
    const Encoded png = shades_png(panel.difference, pixels_most);
    add_title(frame, figure);
    figure.items.push_back(
        Raster{left, top, width, height, png.bytes, false, png.columns, png.rows});
    panel.parts.empty() ? add_x_axis(frame, figure) : add_parts(frame, figure);
    add_y_axis(frame, figure);

    Marks truth{Shape::dot, 0.7, truth_colour, {}};
    for (const MatrixMatch &match : panel.truth)
        truth.spots.push_back(frame.spot(match));
    figure.items.push_back(truth);
    const double radius = panel.parts.empty() ? 1.8 : 1.3;
    add_marks(frame, panel.nearest, 0.6 * radius, figure);
    add_marks(frame, panel.matches, radius, figure);

    const Colour edge = panel.is_chosen ? chosen_colour : faint;
    figure.items.push_back(Line{{{left, top},
                                 {left + width, top},
                                 {left + width, top + height},
                                 {left, top + height},
                                 {left, top}},
                                edge,
                                panel.is_chosen ? 2.5 : 1});
    return figure;
}

Figure legend_figure(const std::vector<MatrixPanel> &panels)
{
    Figure figure{"", "Legend of the difference matrices", 0, 0};
    add_scale(panels.front().difference, figure);
    Legend legend(figure);
    const std::string answer =
        has(panels, &MatrixPanel::nearest) ? "filter's answer" : "nearest frame";
    if (has(panels, Verdict::right))
        legend.add(marks_of(Verdict::right, 3), answer + ", right");
    if (has(panels, Verdict::wrong))
        legend.add(marks_of(Verdict::wrong, 3), answer + ", wrong");
    if (has(panels, Verdict::unknown))
        legend.add(marks_of(Verdict::unknown, 3), answer + ", not known whether right");
    if (has(panels, &MatrixPanel::nearest))
        legend.add(marks_of(Verdict::unknown, 1.5), "small: nearest frame by itself");
    if (has(panels, &MatrixPanel::truth))
        legend.add({Shape::dot, 2, truth_colour, {}}, "same place in truth");
    return figure;
}

} // namespace vdna::report
