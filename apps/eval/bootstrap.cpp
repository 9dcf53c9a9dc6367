#include "eval/bootstrap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace vdna::eval
{

namespace
{

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

std::vector<double> sorted_resample_means(const std::vector<double> &values)
{
    std::mt19937 random(1);
    std::vector<double> means;
    for (uint32_t k = 0; k < bootstrap_resamples; k++) {
        double sum = 0;
        for (size_t i = 0; i < values.size(); i++)
            sum += values[random() % values.size()];
        means.push_back(sum / static_cast<double>(values.size()));
    }
    std::sort(means.begin(), means.end());
    return means;
}

} // namespace

double quantile(const std::vector<double> &sorted, double share)
{
    const double at = share * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<size_t>(at);
    const size_t above = std::min(below + 1, sorted.size() - 1);
    return sorted[below] + (at - std::floor(at)) * (sorted[above] - sorted[below]);
}

Mean mean_with_interval(const std::vector<double> &values)
{
    if (values.empty())
        return {undefined, undefined, undefined};
    const double mean =
        std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    if (values.size() == 1)
        return {mean, undefined, undefined};
    const std::vector<double> means = sorted_resample_means(values);
    return {mean, quantile(means, 0.025), quantile(means, 0.975)};
}

} // namespace vdna::eval
