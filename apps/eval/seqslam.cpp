#include "eval/seqslam.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "program/interrupt.hpp"
#include "record/localisation.hpp"

namespace vdna::eval
{

namespace
{

std::vector<double> distances_of(const Drive &drive, uint32_t frame, const vdna_experience &map)
{
    std::vector<double> distances;
    for (uint32_t j = 0; j < map.frames; j++)
        distances.push_back(record::embedding_distance(
            drive.embedding(frame), map.embeddings + size_t{drive.dim} * j, drive.dim));
    return distances;
}

// The sum along the line that ends at map frame `end`. What would lie before the first map frame
// counts as the first.
double sum_along(const std::vector<std::vector<double>> &rows, size_t end, size_t velocity_tenths)
{
    double sum = 0;
    for (size_t back = 0; back < rows.size(); back++)
        sum += rows[back][end - std::min(end, (velocity_tenths * back + 5) / 10)];
    return sum;
}

} // namespace

std::vector<double> local_contrast(const std::vector<double> &distances)
{
    std::vector<double> contrast;
    for (size_t i = 0; i < distances.size(); i++) {
        const auto begin =
            distances.begin() + static_cast<ptrdiff_t>(i - std::min<size_t>(i, seqslam_neighbours));
        const auto end =
            distances.begin() +
            static_cast<ptrdiff_t>(std::min(i + seqslam_neighbours + 1, distances.size()));
        const auto count = static_cast<double>(end - begin);
        const double mean = std::accumulate(begin, end, 0.0) / count;
        const double square = std::accumulate(
            begin, end, 0.0, [&](double sum, double d) { return sum + (d - mean) * (d - mean); });
        const auto [least, most] = std::minmax_element(begin, end);
        contrast.push_back(*least < *most ? (distances[i] - mean) / std::sqrt(square / count) : 0);
    }
    return contrast;
}

uint32_t best_line_end(const std::vector<std::vector<double>> &rows)
{
    uint32_t best = 0;
    double least = HUGE_VAL;
    for (uint32_t end = 0; end < rows.front().size(); end++)
        for (const uint32_t tenths : seqslam_velocity_tenths) {
            const double sum = sum_along(rows, end, tenths);
            if (sum < least) {
                least = sum;
                best = end;
            }
        }
    return best;
}

std::vector<Answer> seqslam(const Drive &drive, const vdna_experience &map)
{
    std::vector<Answer> answers;
    std::vector<std::vector<double>> rows; // newest first
    uint32_t frame =
        drive.live.front() - std::min(drive.live.front() - drive.begin, seqslam_frames - 1);
    for (const uint32_t asked : drive.live) {
        // With a stride, the frames in between belong to the sequence as well.
        for (; frame <= asked; frame++) {
            program::require_not_interrupted();
            rows.insert(rows.begin(), local_contrast(distances_of(drive, frame, map)));
            rows.resize(std::min<size_t>(rows.size(), seqslam_frames));
        }
        answers.push_back({best_line_end(rows), {}});
    }
    return answers;
}

} // namespace vdna::eval
