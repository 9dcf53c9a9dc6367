// Charts as figures, without a name: axes, and the data in colours by series.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "report/figure.hpp"

namespace vdna::report
{

struct Point {
    double x, y;
    size_t series;     // determines the colour
    std::string label; // tooltip
    // Of y; not drawn if NaN, or but for diagonal_chart().
    double low = std::numeric_limits<double>::quiet_NaN(), high = low;
};

struct Curve {
    std::string label;
    std::vector<double> heights; // at 1, 2, ...; at least one
};

// A value with its interval; only the value is drawn if the interval is NaN.
struct Whisker {
    double value, low, high;
    std::string label; // tooltip
};

// Whiskers side by side above one name on the x axis: one of each series.
struct WhiskerGroup {
    std::string name;
    std::vector<Whisker> whiskers;
};

struct Tick {
    double value;
    std::string text;
};

// Round numbers from low to high, at most about `steps` of them.
std::vector<Tick> ticks_of(double low, double high, double steps = 5);

// The colour of one series among several, for points, curves and the legend.
Colour series_colour(size_t series, size_t count);

// The colours of series, with their names.
Figure key_figure(const std::vector<std::string> &names);

// y from 0 to y_end.
Figure scatter_chart(const std::string &x_label, const std::string &y_label, double y_end,
                     const std::vector<Point> &points, size_t series_count);

// y from 0 to the highest.
Figure curve_chart(const std::string &x_label, const std::string &y_label,
                   const std::vector<Curve> &curves);

// y from 0 to y_end.
Figure whisker_chart(const std::string &y_label, double y_end,
                     const std::vector<WhiskerGroup> &groups);

// Something that holds from one x to another, in a lane.
struct Stretch {
    size_t lane;
    double begin, end;
};

struct Mark {
    double x;
    std::string name;
};

// Lanes one below another, each with its name; x from 0 to x_end, with a line at each mark.
Figure lane_chart(const std::string &x_label, double x_end, const std::vector<std::string> &lanes,
                  const std::vector<Stretch> &stretches, const std::vector<Mark> &marks);

// Points joined in their order, x from 0 to x_end and y from 0 to y_end, with the diagonal.
Figure diagonal_chart(const std::string &x_label, double x_end, const std::string &y_label,
                      double y_end, const std::vector<Point> &points);

} // namespace vdna::report
