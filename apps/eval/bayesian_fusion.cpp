#include "eval/bayesian_fusion.hpp"

#include <algorithm>
#include <cmath>

#include "eval/filter.hpp"

namespace vdna::eval
{

namespace
{

// Add what one reference says of each live frame to the sums, [live frames][places].
void add(const Drive &drive, const Reference &reference, std::vector<std::vector<double>> &sums)
{
    size_t i = 0;
    follow(drive, reference.map, [&](const vdna_localise_answer &, const float *distances) {
        const std::vector<double> odds = log_odds(distances, reference.map.frames);
        for (size_t place = 0; place < reference.frame_at.size(); place++)
            if (reference.frame_at[place] < reference.map.frames)
                sums[i][place] += odds[reference.frame_at[place]];
        i++;
    });
}

} // namespace

std::vector<double> log_odds(const float *distances, uint32_t frames)
{
    double mean = 0, square = 0;
    for (uint32_t j = 0; j < frames; j++)
        mean += double{distances[j]} / frames;
    for (uint32_t j = 0; j < frames; j++)
        square += (distances[j] - mean) * (distances[j] - mean) / frames;
    std::vector<double> odds(frames);
    for (uint32_t j = 0; j < frames && square > 0; j++) {
        const double nearer = std::max(mean - distances[j], 0.0);
        odds[j] = nearer * nearer / (2 * square);
    }
    return odds;
}

std::vector<Answer> most_likely(const Drive &drive, const std::vector<Reference> &references)
{
    std::vector<std::vector<double>> sums(drive.live.size(),
                                          std::vector<double>(references.front().frame_at.size()));
    for (const Reference &reference : references)
        add(drive, reference, sums);
    std::vector<Answer> answers;
    for (const std::vector<double> &sum : sums)
        answers.push_back(
            {static_cast<uint32_t>(std::max_element(sum.begin(), sum.end()) - sum.begin()), {}});
    return answers;
}

} // namespace vdna::eval
