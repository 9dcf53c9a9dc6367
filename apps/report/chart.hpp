// Charts as inline SVG, in the colours of the page.
#pragma once

#include <string>
#include <vector>

namespace vdna::report
{

struct Point {
    double x, y;
    size_t series;     // determines the colour
    std::string label; // tooltip
};

struct Curve {
    std::string label;
    std::vector<double> heights; // at 1, 2, ...; at least one
};

// The colour of one series among several, for points, curves and the legend.
std::string series_colour(size_t series, size_t count);

// y from 0 to y_end.
std::string scatter_chart(const std::string &x_label, const std::string &y_label, double y_end,
                          const std::vector<Point> &points, size_t series_count);

// y from 0 to the highest.
std::string curve_chart(const std::string &x_label, const std::string &y_label,
                        const std::vector<Curve> &curves);

} // namespace vdna::report
