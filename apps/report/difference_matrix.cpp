#include "report/difference_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "program/interrupt.hpp"
#include "program/replaced_file.hpp"

namespace vdna::report
{

namespace
{

// All matrices are in memory at once, because they share one scale.
constexpr uint64_t cells_max = uint64_t{1} << 27;
// The longest side of all matrices is scaled into these limits, in pixels.
constexpr uint32_t side_min = 600, side_max = 1600;
constexpr int margin = 16, title_height = 44, width_min = 260; // pixels

// Distances of the embeddings, [live frames][map frames].
cv::Mat matrix_of(const record::Recording &live, const vdna_experience &experience)
{
    cv::Mat matrix(static_cast<int>(live.frames), static_cast<int>(experience.frames), CV_32F);
    for (int i = 0; i < matrix.rows; i++) {
        program::require_not_interrupted();
        const float *embedding = &live.embeddings[static_cast<size_t>(i) * experience.identity.dim];
        for (int j = 0; j < matrix.cols; j++)
            matrix.at<float>(i, j) = static_cast<float>(record::embedding_distance(
                embedding, experience.embeddings + static_cast<size_t>(j) * experience.identity.dim,
                experience.identity.dim));
    }
    return matrix;
}

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

void dot_matches(const record::Localisation &localisation, double zoom, cv::Mat &picture)
{
    const cv::Scalar blue(230, 150, 30), orange(20, 130, 255);
    for (size_t i = 0; i < localisation.matches.size(); i++) {
        const record::Match &match = localisation.matches[i];
        const cv::Point at(static_cast<int>((match.frame + 0.5) * zoom),
                           static_cast<int>((static_cast<double>(i) + 0.5) * zoom));
        cv::circle(picture, at, std::max(2, static_cast<int>(zoom / 3)),
                   match.good || !match.judged ? blue : orange, cv::FILLED, cv::LINE_AA);
    }
}

std::string title_of(const record::Localisation &localisation)
{
    if (localisation.judged() == 0)
        return "not labelled alike";
    char text[64];
    std::snprintf(text, sizeof text, "Recall@1 %.1f %%", localisation.recall_percent());
    return text;
}

// Pixels per cell: an integer, or less than one if there are so many cells that they are averaged.
double zoom_of(const record::Recording &live,
               const std::vector<const vdna_experience *> &experiences)
{
    uint32_t longest = live.frames;
    for (const vdna_experience *experience : experiences)
        longest = std::max(longest, experience->frames);
    const double side = std::clamp(longest, side_min, side_max);
    const double zoom = side / longest;
    return zoom > 1 ? std::ceil(zoom) : zoom;
}

// One matrix with its title and matches, on white.
cv::Mat panel_of(const cv::Mat &matrix, const std::pair<double, double> &scale, double zoom,
                 const record::Localisation &localisation)
{
    const double span = std::max(scale.second - scale.first, 1e-12);
    cv::Mat grey, picture;
    matrix.convertTo(grey, CV_8U, 255 / span, -255 * scale.first / span);
    cv::resize(grey, grey, {}, zoom, zoom, zoom >= 1 ? cv::INTER_NEAREST : cv::INTER_AREA);
    cv::cvtColor(grey, picture, cv::COLOR_GRAY2BGR);
    dot_matches(localisation, zoom, picture);

    const int right = margin + std::max(0, width_min - picture.cols);
    cv::copyMakeBorder(picture, picture, title_height, margin, margin, right, cv::BORDER_CONSTANT,
                       cv::Scalar::all(255));
    const auto write = [&](const std::string &text, int y) {
        cv::putText(picture, text, {margin, y}, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar::all(0),
                    1, cv::LINE_AA);
    };
    write(localisation.experience, 18);
    write(title_of(localisation), 36);
    return picture;
}

} // namespace

void draw_difference_matrices(const record::Recording &live,
                              const std::vector<const vdna_experience *> &experiences,
                              const std::vector<record::Localisation> &localisations,
                              const std::string &png)
{
    require_drawable(live, experiences, png);
    std::vector<cv::Mat> matrices;
    for (const vdna_experience *experience : experiences)
        matrices.push_back(matrix_of(live, *experience));
    const std::pair<double, double> scale = scale_of(matrices);

    const double zoom = zoom_of(live, experiences);
    std::vector<cv::Mat> panels;
    for (size_t i = 0; i < matrices.size(); i++)
        panels.push_back(panel_of(matrices[i], scale, zoom, localisations[i]));
    cv::Mat picture;
    cv::hconcat(panels, picture);
    std::vector<uchar> bytes;
    cv::imencode(".png", picture, bytes);
    program::replace_file(png, {bytes.begin(), bytes.end()}, program::Durability::quick);
}

} // namespace vdna::report
