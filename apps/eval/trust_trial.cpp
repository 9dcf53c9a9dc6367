#include "eval/trust_trial.hpp"

#include <cmath>
#include <limits>

#include <vdna/cpp/error.hpp>
#include <vdna/cpp/trust.hpp>

namespace vdna::eval
{

namespace
{

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

TrustBlock trust_by(const record::TrustTables &tables, uint32_t localiser)
{
    const vdna_trust_tables view = tables.view();
    vdna_trust_config config = trust_defaults();
    config.runs = static_cast<uint32_t>(tables.frames.size());
    config.tables = &view;
    config.localiser = localiser;
    return {config, "tables of trust"};
}

Forecast forecast(TrustBlock &trust, const std::vector<double> &bins, size_t runs)
{
    Forecast found{std::vector<vdna_trust_prediction>(runs), std::vector<double>(runs), {}};
    require(vdna_trust_predict(trust.get(), bins.empty() ? nullptr : bins.data(),
                               found.predictions.data(), &found.answer),
            "prediction");
    const double slope = trust.fit().slope;
    const double *intercept = vdna_trust_intercepts(trust.get());
    for (size_t b = 0; b < runs; b++)
        found.angle[b] =
            intercept[b] + slope * std::log(std::max(found.predictions[b].nearest, 1e-6));
    return found;
}

// Mean over the windows of each other run, and over these runs.
double mean_recall_in(const record::TrustTables &tables, size_t candidate)
{
    const size_t runs = tables.frames.size();
    double sum = 0;
    for (size_t a = 0; a < runs; a++) {
        if (a == candidate)
            continue;
        const uint32_t windows = vdna_trust_windows(tables.frames[a], nullptr, nullptr);
        for (uint32_t i = 0; i < windows; i++)
            sum += tables.cells[a * runs + candidate].recall[i] / windows;
    }
    return runs > 1 ? sum / static_cast<double>(runs - 1) : unknown;
}

std::vector<double> picked(const std::vector<double> &table, size_t columns,
                           const std::vector<uint32_t> &runs)
{
    std::vector<double> part;
    for (size_t row = 0; row < table.size(); row += columns)
        for (const uint32_t run : runs)
            part.push_back(table[row + run]);
    return part;
}

} // namespace

record::TrustTables tables_of(const record::TrustTables &tables, const std::vector<uint32_t> &runs)
{
    record::TrustTables part;
    for (const uint32_t a : runs) {
        part.frames.push_back(tables.frames[a]);
        part.own_scale.push_back(tables.own_scale[a]);
        part.correlation.push_back(tables.correlation[a]);
        for (const uint32_t b : runs)
            part.cells.push_back(tables.cells[a * tables.frames.size() + b]);
    }
    return part;
}

LiveFrames frames_in(const LiveFrames &live, size_t runs_before, const std::vector<uint32_t> &runs)
{
    return {live.frames, picked(live.nearest, runs_before, runs),
            picked(live.likeness, runs_before, runs), picked(live.bins, runs_before, runs),
            picked(live.bins_early, runs_before, runs)};
}

Trial try_trust(const record::TrustTables &tables, uint32_t localiser, const LiveFrames &live)
{
    const size_t runs = tables.frames.size();
    TrustBlock trust = trust_by(tables, localiser);
    Trial trial;
    trial.fit = trust.fit();
    for (size_t b = 0; b < runs; b++)
        trial.constant.push_back(mean_recall_in(tables, b));
    for (uint32_t i = 0; i < live.frames; i++) {
        require(vdna_trust_feed(trust.get(), &live.nearest[i * runs],
                                live.likeness.empty() ? nullptr : &live.likeness[i * runs]),
                "frame of a warmup");
        if (i + 1 == VDNA_TRUST_SETTLED_FRAMES)
            trial.early = forecast(trust, live.bins_early, runs);
        if (trial.settled_frames == 0 && vdna_trust_settled_frames(trust.get()) > 0) {
            trial.settled_frames = vdna_trust_settled_frames(trust.get());
            trial.settled_choice = forecast(trust, {}, runs).answer.choice;
        }
    }
    trial.full = forecast(trust, live.bins, runs);
    if (trial.settled_frames == 0)
        trial.settled_choice = trial.full.answer.choice;
    return trial;
}

} // namespace vdna::eval
