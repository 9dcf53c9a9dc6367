#include "report/chart.hpp"

#include <algorithm>
#include <cmath>

#include "program/print.hpp"
#include "report/html.hpp"

namespace vdna::report
{

namespace
{

// In drawing units; the drawing is scaled to the space on the page.
constexpr double width = 360, height = 250;
constexpr double left = 48, right = 10, top = 10, bottom = 42;
constexpr size_t points_of_a_curve = 200; // more are indistinguishable

struct Axis {
    std::string label;
    double low, high;

    // 0..1
    double share(double value) const { return (value - low) / (high - low); }

    // 1, 2 or 5 times a power of ten; the axis has at most five steps.
    double step() const
    {
        const double rough = (high - low) / 5;
        const double power = std::pow(10, std::floor(std::log10(rough)));
        for (const double factor : {1.0, 2.0, 5.0})
            if (factor * power >= rough)
                return factor * power;
        return 10 * power;
    }
};

Axis axis_of(const std::string &label, double low, double high)
{
    return {label, low, high > low ? high : low + 1};
}

double x_of(const Axis &axis, double value)
{
    return left + axis.share(value) * (width - left - right);
}

double y_of(const Axis &axis, double value)
{
    return height - bottom - axis.share(value) * (height - top - bottom);
}

std::string line(double x1, double y1, double x2, double y2)
{
    return "<line x1=\"" + program::fixed(x1, 1) + "\" y1=\"" + program::fixed(y1, 1) + "\" x2=\"" +
           program::fixed(x2, 1) + "\" y2=\"" + program::fixed(y2, 1) + "\"/>";
}

std::string label_at(double x, double y, const std::string &attributes, const std::string &text)
{
    return text_element("text x=\"" + program::fixed(x, 1) + "\" y=\"" + program::fixed(y, 1) +
                            "\"" + attributes,
                        text);
}

std::string tick_text(double value, double step)
{
    const int digits = static_cast<int>(std::max(0.0, -std::floor(std::log10(step) + 1e-9)));
    return program::fixed(value, digits);
}

// A line and its number at each step.
template <typename Draw>
void for_each_tick(const Axis &axis, Draw draw)
{
    const double step = axis.step();
    const auto first = static_cast<int>(std::ceil(axis.low / step - 1e-9));
    for (int i = first; i * step <= axis.high + step * 1e-9; i++)
        draw(i * step, tick_text(i * step, step));
}

std::string x_ticks(const Axis &x)
{
    std::string svg;
    for_each_tick(x, [&](double value, const std::string &text) {
        svg += line(x_of(x, value), top, x_of(x, value), height - bottom);
        svg += label_at(x_of(x, value), height - bottom + 14, " text-anchor=\"middle\"", text);
    });
    return svg +
           label_at((left + width - right) / 2, height - 8, " text-anchor=\"middle\"", x.label);
}

std::string y_ticks(const Axis &y)
{
    std::string svg;
    for_each_tick(y, [&](double value, const std::string &text) {
        svg += line(left, y_of(y, value), width - right, y_of(y, value));
        svg += label_at(left - 5, y_of(y, value) + 4, " text-anchor=\"end\"", text);
    });
    const double middle = (top + height - bottom) / 2;
    return svg + label_at(12, middle,
                          " text-anchor=\"middle\" transform=\"rotate(-90 12 " +
                              program::fixed(middle, 1) + ")\"",
                          y.label);
}

std::string axes(const Axis &x, const Axis &y)
{
    return x_ticks(x) + y_ticks(y);
}

std::string drawing(const std::string &text, const std::string &svg)
{
    return element("svg viewBox=\"0 0 " + program::fixed(width, 0) + " " +
                       program::fixed(height, 0) + "\" role=\"img\" aria-label=\"" + escaped(text) +
                       "\"",
                   svg);
}

std::string dot(const Axis &x, const Axis &y, const Point &point, size_t series_count)
{
    return element("circle cx=\"" + program::fixed(x_of(x, point.x), 1) + "\" cy=\"" +
                       program::fixed(y_of(y, point.y), 1) + "\" r=\"4.5\" fill=\"" +
                       series_colour(point.series, series_count) + "\"",
                   text_element("title", point.label));
}

std::string polyline(const Axis &x, const Axis &y, const std::vector<double> &heights)
{
    std::string points;
    const size_t count = std::min(heights.size(), points_of_a_curve);
    for (size_t i = 0; i < count; i++) {
        // Always include the first and the last.
        const size_t at = count > 1 ? i * (heights.size() - 1) / (count - 1) : 0;
        points += program::fixed(x_of(x, static_cast<double>(at + 1)), 1) + "," +
                  program::fixed(y_of(y, heights[at]), 1) + " ";
    }
    return points;
}

// Points of the drawing as a line.
std::string path(const std::vector<Point> &points, const Axis &x, const Axis &y,
                 const std::string &stroke)
{
    std::string text;
    for (const Point &point : points)
        text +=
            program::fixed(x_of(x, point.x), 1) + "," + program::fixed(y_of(y, point.y), 1) + " ";
    return element(
        "polyline fill=\"none\" stroke-width=\"2\" " + stroke + " points=\"" + text + "\"", "");
}

// At this x of the drawing.
std::string whisker(const Whisker &shown, double at, const Axis &y, const std::string &colour)
{
    const std::string x = program::fixed(at, 1);
    const std::string interval =
        std::isnan(shown.low)
            ? ""
            : element("polyline stroke-width=\"2\" stroke=\"" + colour + "\" points=\"" + x + "," +
                          program::fixed(y_of(y, shown.low), 1) + " " + x + "," +
                          program::fixed(y_of(y, shown.high), 1) + "\"",
                      "");
    return interval +
           element("circle cx=\"" + x + "\" cy=\"" + program::fixed(y_of(y, shown.value), 1) +
                       "\" r=\"4.5\" fill=\"" + colour + "\"",
                   text_element("title", shown.label));
}

} // namespace

std::string series_colour(size_t series, size_t count)
{
    return "hsl(" + std::to_string((210 + 360 * series / std::max<size_t>(count, 1)) % 360) +
           " 70% 48%)";
}

std::string scatter_chart(const std::string &x_label, const std::string &y_label, double y_end,
                          const std::vector<Point> &points, size_t series_count)
{
    double low = 0, high = 0;
    for (size_t i = 0; i < points.size(); i++) {
        low = i == 0 ? points[i].x : std::min(low, points[i].x);
        high = i == 0 ? points[i].x : std::max(high, points[i].x);
    }
    const double margin = 0.05 * (high - low);
    const Axis x = axis_of(x_label, low - margin, high + margin);
    const Axis y = axis_of(y_label, 0, y_end);
    std::string svg = axes(x, y);
    for (const Point &point : points)
        svg += dot(x, y, point, series_count);
    return drawing(y_label + " against " + x_label, svg);
}

std::string curve_chart(const std::string &x_label, const std::string &y_label,
                        const std::vector<Curve> &curves)
{
    size_t longest = 1;
    double highest = 0;
    for (const Curve &curve : curves) {
        longest = std::max(longest, curve.heights.size());
        highest = std::max(highest, *std::max_element(curve.heights.begin(), curve.heights.end()));
    }
    const Axis x = axis_of(x_label, 1, static_cast<double>(longest));
    const Axis y = axis_of(y_label, 0, highest);
    std::string svg = axes(x, y);
    for (size_t i = 0; i < curves.size(); i++)
        svg += element("polyline fill=\"none\" stroke-width=\"2\" stroke=\"" +
                           series_colour(i, curves.size()) + "\" points=\"" +
                           polyline(x, y, curves[i].heights) + "\"",
                       text_element("title", curves[i].label));
    return drawing(y_label + " against " + x_label, svg);
}

std::string whisker_chart(const std::string &y_label, double y_end,
                          const std::vector<WhiskerGroup> &groups)
{
    const Axis y = axis_of(y_label, 0, y_end);
    const double group_width = (width - left - right) / static_cast<double>(groups.size());
    std::string svg = y_ticks(y), names;
    for (size_t g = 0; g < groups.size(); g++) {
        const std::vector<Whisker> &whiskers = groups[g].whiskers;
        const double begin = left + static_cast<double>(g) * group_width;
        svg += label_at(begin + group_width / 2, height - bottom + 16, " text-anchor=\"middle\"",
                        groups[g].name);
        for (size_t i = 0; i < whiskers.size(); i++) {
            const double share =
                static_cast<double>(i + 1) / static_cast<double>(whiskers.size() + 1);
            svg += whisker(whiskers[i], begin + share * group_width, y,
                           series_colour(i, whiskers.size()));
        }
        names += (g > 0 ? ", " : "") + groups[g].name;
    }
    return drawing(y_label + " of " + names, svg);
}

std::string lane_chart(const std::string &x_label, double x_end,
                       const std::vector<std::string> &lanes, const std::vector<Stretch> &stretches,
                       const std::vector<Mark> &marks)
{
    // The names of the marks have a lane of their own, above the others.
    const Axis x = axis_of(x_label, 0, x_end);
    const auto y_of_lane = [&](size_t lane) {
        const double share =
            (static_cast<double>(lane) + 1.6) / static_cast<double>(lanes.size() + 1);
        return top + share * (height - top - bottom);
    };
    std::string svg = x_ticks(x), names;
    for (const Mark &mark : marks) {
        const std::string at = program::fixed(x_of(x, mark.x), 1);
        svg += element("polyline stroke=\"currentColor\" stroke-dasharray=\"4\" points=\"" + at +
                           "," + program::fixed(top, 1) + " " + at + "," +
                           program::fixed(height - bottom, 1) + "\"",
                       "");
        svg += label_at(x_of(x, mark.x) + 4, top + 12, "", mark.name);
    }
    for (size_t lane = 0; lane < lanes.size(); lane++) {
        svg += label_at(left + 4, y_of_lane(lane) - 8, "", lanes[lane]);
        names += (lane > 0 ? ", " : "") + lanes[lane];
    }
    for (const Stretch &stretch : stretches) {
        const std::string height_text = program::fixed(y_of_lane(stretch.lane), 1);
        svg += element("polyline stroke-width=\"7\" stroke=\"" +
                           series_colour(stretch.lane, lanes.size()) + "\" points=\"" +
                           program::fixed(x_of(x, stretch.begin), 1) + "," + height_text + " " +
                           program::fixed(x_of(x, stretch.end), 1) + "," + height_text + "\"",
                       "");
    }
    return drawing(names + " against " + x_label, svg);
}

std::string diagonal_chart(const std::string &x_label, double x_end, const std::string &y_label,
                           double y_end, const std::vector<Point> &points)
{
    const Axis x = axis_of(x_label, 0, x_end), y = axis_of(y_label, 0, y_end);
    std::string svg = axes(x, y);
    svg += line(x_of(x, 0), y_of(y, 0), x_of(x, x_end), y_of(y, y_end));
    svg += path(points, x, y, "stroke=\"" + series_colour(0, 1) + "\"");
    for (const Point &point : points)
        svg += whisker({point.y, point.low, point.high, point.label}, x_of(x, point.x), y,
                       series_colour(0, 1));
    return drawing(y_label + " against " + x_label, svg);
}

} // namespace vdna::report
