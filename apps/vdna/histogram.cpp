#include "histogram.hpp"

#include <numeric>

#include "check.hpp"

namespace vdna
{

Histogram::Histogram(const std::vector<float> &range, uint32_t bins)
{
    vdna_hist_config config;
    vdna_hist_config_init(&config);
    config.neurons = static_cast<uint32_t>(range.size() / 2);
    config.bins = bins;
    config.range = range.data();
    mem_.resize(vdna_hist_mem_size(&config) / sizeof(uint32_t) + 1);
    require_ok(vdna_hist_init(&config, mem_.data(), mem_.size() * sizeof(uint32_t), &hist_),
               "histogram");
}

void Histogram::add(const vdna_activations *taps, size_t tap_count, const std::string &where)
{
    require_ok(vdna_hist_add(&hist_, taps, tap_count), where);
}

double Histogram::saturated_share() const
{
    const auto sum = [&](const uint32_t *values) {
        return std::accumulate(values, values + hist_.neurons, 0.0);
    };
    return hist_.frames == 0 ? 0 : sum(hist_.saturated) / sum(hist_.mass);
}

} // namespace vdna
