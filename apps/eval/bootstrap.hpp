// Means over queries, with intervals.
#pragma once

#include <cstdint>
#include <vector>

namespace vdna::eval
{

constexpr uint32_t bootstrap_resamples = 2000;

// A mean with its 95 % bootstrap interval over the values (percentile method).
struct Mean {
    double value;     // NaN of no values
    double low, high; // NaN of fewer than two values
};

// Interpolated linearly. sorted: at least one value; share: 0..1
double quantile(const std::vector<double> &sorted, double share);

// The same values give the same interval everywhere: resample k takes the values number
// random() % n, n times, of a std::mt19937 with seed 1 that runs through all resamples; `low` and
// `high` are the quantiles 0.025 and 0.975 of the resamples' means, interpolated linearly.
Mean mean_with_interval(const std::vector<double> &values);

} // namespace vdna::eval
