#include "report/difference_matrix.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "program/print.hpp"
#include "program/replaced_file.hpp"

namespace vdna::report
{

namespace
{

// All matrices are in memory at once, because they share one scale.
constexpr uint64_t cells_max = uint64_t{1} << 27;
// The longest side of all matrices is scaled into these limits, in pixels.
constexpr int side_min = 600, side_max = 1600;
constexpr int margin = 16, title_height = 44, width_min = 300; // pixels

// Least and greatest entry over all matrices.
std::pair<double, double> scale_of(const std::vector<cv::Mat> &matrices)
{
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    for (const cv::Mat &matrix : matrices) {
        double least = 0, greatest = 0;
        cv::minMaxLoc(matrix, &least, &greatest);
        lo = std::min(lo, least);
        hi = std::max(hi, greatest);
    }
    return {lo, hi};
}

struct Colours {
    cv::Scalar right, wrong;
};
const Colours of_nearest = {{230, 150, 30}, {20, 130, 255}}; // blue, orange
const Colours of_filter = {{60, 200, 60}, {60, 20, 220}};    // green, red

void dot_matches(const record::Localisation &localisation, const Colours &colours, double zoom,
                 int radius, cv::Mat &picture)
{
    for (size_t i = 0; i < localisation.matches.size(); i++) {
        const record::Match &match = localisation.matches[i];
        const cv::Point at(static_cast<int>((match.frame + 0.5) * zoom),
                           static_cast<int>((static_cast<double>(i) + 0.5) * zoom));
        cv::circle(picture, at, radius, match.good || !match.judged ? colours.right : colours.wrong,
                   cv::FILLED, cv::LINE_AA);
    }
}

std::string title_of(const record::Followed &followed, bool with_filter)
{
    if (followed.nearest.judged() == 0)
        return "not labelled alike";
    const auto recall = [](const record::Localisation &localisation) {
        return program::fixed(localisation.recall_percent(), 1) + " %";
    };
    const std::string nearest = recall(followed.nearest);
    return with_filter ? "filter " + recall(followed.filter) + ", nearest " + nearest
                       : "Recall@1 " + nearest;
}

// Pixels per cell: an integer, or less than one if there are so many cells that they are averaged.
double zoom_of(const std::vector<cv::Mat> &matrices)
{
    int longest = 1;
    for (const cv::Mat &matrix : matrices)
        longest = std::max({longest, matrix.rows, matrix.cols});
    const double zoom = static_cast<double>(std::clamp(longest, side_min, side_max)) / longest;
    return zoom > 1 ? std::ceil(zoom) : zoom;
}

// One matrix with its title and matches, on white.
cv::Mat panel_of(const cv::Mat &distances, const std::pair<double, double> &scale, double zoom,
                 const record::Followed &followed, bool with_filter)
{
    const double span = std::max(scale.second - scale.first, 1e-12);
    cv::Mat grey, picture;
    distances.convertTo(grey, CV_8U, 255 / span, -255 * scale.first / span);
    cv::resize(grey, grey, {}, zoom, zoom, zoom >= 1 ? cv::INTER_NEAREST : cv::INTER_AREA);
    cv::cvtColor(grey, picture, cv::COLOR_GRAY2BGR);
    const int radius = std::max(2, static_cast<int>(zoom / 3));
    dot_matches(followed.nearest, of_nearest, zoom, radius, picture);
    if (with_filter)
        dot_matches(followed.filter, of_filter, zoom, std::max(1, radius / 2), picture);

    const int right = margin + std::max(0, width_min - picture.cols);
    cv::copyMakeBorder(picture, picture, title_height, margin, margin, right, cv::BORDER_CONSTANT,
                       cv::Scalar::all(255));
    const auto write = [&](const std::string &text, int y) {
        cv::putText(picture, text, {margin, y}, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar::all(0),
                    1, cv::LINE_AA);
    };
    write(followed.nearest.experience, 18);
    write(title_of(followed, with_filter), 36);
    return picture;
}

} // namespace

void require_drawable(const record::Recording &live,
                      const std::vector<const vdna_experience *> &experiences,
                      const std::string &png)
{
    uint64_t cells = 0;
    for (const vdna_experience *experience : experiences)
        cells += uint64_t{live.frames} * experience->frames;
    if (cells > cells_max)
        throw Error(png + ": " + std::to_string(cells) + " frame pairs, expected at most " +
                    std::to_string(cells_max) + "; set --every or --in");
}

void draw_difference_matrices(const std::vector<record::Followed> &followed, bool with_filter,
                              const std::string &png)
{
    std::vector<cv::Mat> distances;
    for (const record::Followed &f : followed)
        distances.push_back(
            cv::Mat(f.distances).reshape(1, static_cast<int>(f.nearest.matches.size())));
    const std::pair<double, double> scale = scale_of(distances);

    const double zoom = zoom_of(distances);
    std::vector<cv::Mat> panels;
    for (size_t i = 0; i < followed.size(); i++)
        panels.push_back(panel_of(distances[i], scale, zoom, followed[i], with_filter));
    cv::Mat picture;
    cv::hconcat(panels, picture);
    std::vector<uchar> bytes;
    cv::imencode(".png", picture, bytes);
    program::replace_file(png, {bytes.begin(), bytes.end()}, program::Durability::quick);
}

} // namespace vdna::report
