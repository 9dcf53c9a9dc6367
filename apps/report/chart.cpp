#include "report/chart.hpp"

#include <algorithm>
#include <cmath>

#include "program/print.hpp"

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

// 1, 2 or 5 times a power of ten; about as many steps as wanted cover the span.
double step_of(double span, double steps)
{
    const double rough = span / steps;
    const double power = std::pow(10, std::floor(std::log10(rough)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (factor * power >= rough)
            return factor * power;
    return 10 * power;
}

std::string tick_text(double value, double step)
{
    const int digits = static_cast<int>(std::max(0.0, -std::floor(std::log10(step) + 1e-9)));
    return program::fixed(value, digits);
}

// A chart without data.
Figure chart_of(const std::string &title)
{
    return {"", title, width, height};
}

void add_x_ticks(const Axis &x, Figure &chart)
{
    for (const auto &[value, text] : ticks_of(x.low, x.high)) {
        chart.items.push_back(
            Line{{{x_of(x, value), top}, {x_of(x, value), height - bottom}}, grid});
        chart.items.push_back(Text{x_of(x, value), height - bottom + 14, text, Anchor::middle});
    }
    chart.items.push_back(Text{(left + width - right) / 2, height - 8, x.label, Anchor::middle});
}

void add_y_ticks(const Axis &y, Figure &chart)
{
    for (const auto &[value, text] : ticks_of(y.low, y.high)) {
        chart.items.push_back(
            Line{{{left, y_of(y, value)}, {width - right, y_of(y, value)}}, grid});
        chart.items.push_back(Text{left - 5, y_of(y, value) + 4, text, Anchor::end});
    }
    chart.items.push_back(
        Text{12, (top + height - bottom) / 2, y.label, Anchor::middle, faint, false, true});
}

Marks dot_at(double x, double y, const Colour &colour, const std::string &label)
{
    return {Shape::dot, 4, colour, {{x, y}}, false, label};
}

Line curve_of(const Axis &x, const Axis &y, const Curve &curve, const Colour &colour)
{
    Line line{{}, colour, 2, false, curve.label};
    const size_t count = std::min(curve.heights.size(), points_of_a_curve);
    for (size_t i = 0; i < count; i++) {
        // Always include the first and the last.
        const size_t at = count > 1 ? i * (curve.heights.size() - 1) / (count - 1) : 0;
        line.spots.push_back({x_of(x, static_cast<double>(at + 1)), y_of(y, curve.heights[at])});
    }
    return line;
}

// At this x of the drawing.
void add_whisker(const Whisker &shown, double at, const Axis &y, const Colour &colour,
                 Figure &chart)
{
    if (!std::isnan(shown.low))
        chart.items.push_back(
            Line{{{at, y_of(y, shown.low)}, {at, y_of(y, shown.high)}}, colour, 2});
    chart.items.push_back(dot_at(at, y_of(y, shown.value), colour, shown.label));
}

// hue: 0..1, at 70 % saturation and 48 % lightness
Colour colour_of_hue(double hue)
{
    const auto channel = [&](double shift) {
        const double turn = std::fmod(hue + shift, 1.0) * 6;
        const double share = turn < 1 ? turn : turn < 3 ? 1 : turn < 4 ? 4 - turn : 0;
        return static_cast<uint8_t>(255 * (0.48 + 0.48 * 0.7 * (2 * share - 1)));
    };
    return {channel(1.0 / 3), channel(0), channel(2.0 / 3)};
}

} // namespace

std::vector<Tick> ticks_of(double low, double high, double steps)
{
    std::vector<Tick> ticks;
    const double step = step_of(high - low, steps);
    const auto first = static_cast<int>(std::ceil(low / step - 1e-9));
    for (int i = first; i * step <= high + step * 1e-9; i++)
        ticks.push_back({i * step, tick_text(i * step, step)});
    return ticks;
}

Colour series_colour(size_t series, size_t count)
{
    constexpr double blue = 210.0 / 360;
    return colour_of_hue(blue + static_cast<double>(series) /
                                    static_cast<double>(std::max<size_t>(count, 1)));
}

Figure key_figure(const std::vector<std::string> &names)
{
    constexpr double row = 17, indent = 20;
    Figure key{"", "Colours", 0, row * static_cast<double>(names.size()) + 4};
    for (size_t i = 0; i < names.size(); i++) {
        const double y = row * static_cast<double>(i) + 12;
        const Text text{indent, y + 4, names[i]};
        key.items.push_back(dot_at(8, y, series_colour(i, names.size()), ""));
        key.items.push_back(text);
        key.width = std::max(key.width, indent + text_room(text) + 4);
    }
    return key;
}

Figure scatter_chart(const std::string &x_label, const std::string &y_label, double y_end,
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
    Figure chart = chart_of(y_label + " against " + x_label);
    add_x_ticks(x, chart);
    add_y_ticks(y, chart);
    for (const Point &point : points)
        chart.items.push_back(dot_at(x_of(x, point.x), y_of(y, point.y),
                                     series_colour(point.series, series_count), point.label));
    return chart;
}

Figure curve_chart(const std::string &x_label, const std::string &y_label,
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
    Figure chart = chart_of(y_label + " against " + x_label);
    add_x_ticks(x, chart);
    add_y_ticks(y, chart);
    for (size_t i = 0; i < curves.size(); i++)
        chart.items.push_back(curve_of(x, y, curves[i], series_colour(i, curves.size())));
    return chart;
}

Figure whisker_chart(const std::string &y_label, double y_end,
                     const std::vector<WhiskerGroup> &groups)
{
    const Axis y = axis_of(y_label, 0, y_end);
    const double group_width = (width - left - right) / static_cast<double>(groups.size());
    Figure chart = chart_of(y_label + " of");
    add_y_ticks(y, chart);
    for (size_t g = 0; g < groups.size(); g++) {
        const std::vector<Whisker> &whiskers = groups[g].whiskers;
        const double begin = left + static_cast<double>(g) * group_width;
        chart.items.push_back(
            Text{begin + group_width / 2, height - bottom + 16, groups[g].name, Anchor::middle});
        for (size_t i = 0; i < whiskers.size(); i++) {
            const double share =
                static_cast<double>(i + 1) / static_cast<double>(whiskers.size() + 1);
            add_whisker(whiskers[i], begin + share * group_width, y,
                        series_colour(i, whiskers.size()), chart);
        }
        chart.title += (g > 0 ? ", " : " ") + groups[g].name;
    }
    return chart;
}

Figure lane_chart(const std::string &x_label, double x_end, const std::vector<std::string> &lanes,
                  const std::vector<Stretch> &stretches, const std::vector<Mark> &marks)
{
    // The names of the marks have a lane of their own, above the others.
    const Axis x = axis_of(x_label, 0, x_end);
    const auto y_of_lane = [&](size_t lane) {
        const double share =
            (static_cast<double>(lane) + 1.6) / static_cast<double>(lanes.size() + 1);
        return top + share * (height - top - bottom);
    };
    Figure chart = chart_of("");
    add_x_ticks(x, chart);
    for (const Mark &mark : marks) {
        const double at = x_of(x, mark.x);
        chart.items.push_back(Line{{{at, top}, {at, height - bottom}}, ink, 1, true});
        chart.items.push_back(Text{at + 4, top + 12, mark.name});
    }
    for (size_t lane = 0; lane < lanes.size(); lane++) {
        chart.items.push_back(Text{left + 4, y_of_lane(lane) - 8, lanes[lane]});
        chart.title += (lane > 0 ? ", " : "") + lanes[lane];
    }
    chart.title += " against " + x_label;
    for (const Stretch &stretch : stretches) {
        const double y = y_of_lane(stretch.lane);
        chart.items.push_back(Line{{{x_of(x, stretch.begin), y}, {x_of(x, stretch.end), y}},
                                   series_colour(stretch.lane, lanes.size()),
                                   7});
    }
    return chart;
}

Figure diagonal_chart(const std::string &x_label, double x_end, const std::string &y_label,
                      double y_end, const std::vector<Point> &points)
{
    const Axis x = axis_of(x_label, 0, x_end), y = axis_of(y_label, 0, y_end);
    const Colour colour = series_colour(0, 1);
    Figure chart = chart_of(y_label + " against " + x_label);
    add_x_ticks(x, chart);
    add_y_ticks(y, chart);
    chart.items.push_back(Line{{{x_of(x, 0), y_of(y, 0)}, {x_of(x, x_end), y_of(y, y_end)}}, grid});
    Line joined{{}, colour, 2};
    for (const Point &point : points)
        joined.spots.push_back({x_of(x, point.x), y_of(y, point.y)});
    chart.items.push_back(joined);
    for (const Point &point : points)
        add_whisker({point.y, point.low, point.high, point.label}, x_of(x, point.x), y, colour,
                    chart);
    return chart;
}

} // namespace vdna::report
